/// drumsweep slurm
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "sweep/job_script.h"
#include "sweep/plan/designs.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

void warn(const std::string& text) { fmt::print(stderr, "drumsweep: warning: {}\n", text); }

void slurm(JobOptions options) {
  const Study study = read_study(options.study_path, options.changes);
  const Plan plan = plan_designs(study);
  const auto designs =
      std::count_if(plan.designs.begin(), plan.designs.end(), [](const auto& d) { return d.impossible.empty(); });

  options.title = study.name;
  options.program = options.program.empty() ? fs::read_symlink("/proc/self/exe").string()
                                            : fs::absolute(options.program).lexically_normal().string();
  if (options.output.empty()) options.output = fs::path(options.study_path).stem().string() + "_result";
  options.study_path = fs::absolute(options.study_path).lexically_normal().string();
  options.output = fs::absolute(options.output).lexically_normal().string();
  while (options.output.size() > 1 && options.output.ends_with('/')) options.output.pop_back();
  const fs::path parent = fs::path(options.output).parent_path();
  if (!fs::is_directory(parent))
    throw InputError(fmt::format("-o {}: the folder {} does not exist, and Slurm makes none for the job's messages",
                                 options.output, parent.string()));

  const std::string script = job_script(options);
  if (const auto limit_s = slurm_time_s(options.time); limit_s <= options.signal_before_s + 60)
    warn(fmt::format("the signal may come a minute early, which leaves nothing of the time limit of {} s", limit_s));
  if (const auto ranks = static_cast<std::int64_t>(options.nodes) * options.tasks_per_node; ranks > designs)
    warn(fmt::format("{} ranks for {} designs: at most {} have work at a time{}", ranks, designs, designs,
                     options.threads == 1 ? "; fewer tasks with more --threads use the rest" : ""));
  fmt::print("{}", script);
}

}  // namespace

void add_slurm(CLI::App& app, int&) {
  auto options = std::make_shared<JobOptions>();
  CLI::App* command = app.add_subcommand(
      "slurm", "Job script for a cluster with Slurm, on standard output: requeues itself until the study is finished.");
  command->add_option("STUDY", options->study_path, "study file (TOML)")->required();
  command->add_option("-N,--nodes", options->nodes, "nodes")->required()->check(CLI::Range(1, 100000));
  command->add_option("-t,--time", options->time, "limit of one start: 90 (minutes), 24:00:00, 2-12 (days-hours) ...")
      ->required();
  command->add_option("-o,--output", options->output, "output folder [default: STUDY's name + _result, here]");
  add_set_option(*command, options->changes);
  command
      ->add_option("--tasks-per-node", options->tasks_per_node,
                   "ranks on a node, one a core [default: whole nodes, one rank a CPU]")
      ->check(CLI::Range(1, 4096));
  command->add_option("--threads", options->threads, "threads of each rank, for fewer designs than cores")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  command->add_option("--launcher", options->launcher, "mpirun (of the Open MPI it was built with) or srun (with PMIx)")
      ->capture_default_str()
      ->check(CLI::IsMember({"mpirun", "srun"}));
  command->add_option("--program", options->program,
                      "what the job runs, e.g. a script around a container [default: this program]");
  command->add_option("-p,--partition", options->partition, "partition");
  command->add_option("-A,--account", options->account, "account");
  command->add_option("--module", options->modules, "module to load in the job; may be given several times");
  command->add_option("--signal-before", options->signal_before_s, "stop in good order this long before the limit [s]")
      ->capture_default_str()
      ->check(CLI::Range(10, 65535));
  command->add_option("--max-requeues", options->max_requeues, "starts after the first; then submit again to go on")
      ->capture_default_str()
      ->check(CLI::Range(0, 10000));
  command->footer(
      "Example:\n"
      "  drumsweep slurm study/plant_pellets.toml -N 4 -t 24:00:00 --tasks-per-node 64 -o out > job.sh\n"
      "  sbatch job.sh\n"
      "  drumsweep status out\n"
      "The job stops in good order before its time limit and goes back into the queue; so it does after a lost node.\n"
      "What is stored decides whether it is finished. Messages: OUT.log, beside OUT. Exit code of the job: that of "
      "run.");
  command->callback([options] { slurm(*options); });
}

}  // namespace drumsweep
