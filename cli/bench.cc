/// drumsweep bench
#include "core/scene/bench.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "sweep/progress.h"

namespace drumsweep {
namespace {

struct BenchArguments {
  BenchOptions bench;
  int threads = 1;
  std::string setting = "s1";
  std::vector<std::string> set;
  bool json = false;
};

void print_json(const BenchResult& r, const BenchArguments& options) {
  JsonObject phases, all;
  for (std::size_t i = 0; i < phase_names.size(); ++i) phases.number(phase_names[i], r.phase_s[i]);
  all.number("balls", r.balls)
      .number("contacts", r.contacts)
      .number("pressed_contacts", r.pressed)
      .count("threads", options.threads);
  all.number("iterations", r.quality.iterations).number("time_step_s", r.time_step_s);
  all.number("outer_step_s", r.study.solver.outer_step_s)
      .number("simulated_s", r.simulated_s)
      .number("cpu_s", r.cpu_s)
      .number("wall_s", r.wall_s);
  all.number("cpu_s_per_1k_balls_per_sim_s", r.cpu_s_per_1k_balls_per_sim_s())
      .number("ns_per_contact_iteration", r.ns_per_contact_iteration());
  all.number("bytes_per_ball", static_cast<double>(r.memory.total()) / r.balls).raw("phases_s", phases.str());
  all.number("residual", r.quality.residual.mean).number("overlap_mean", r.quality.mean_overlap);
  all.text("state_hash", fmt::format("{:016x}", r.hash)).text("simd_target", simd_target());
  fmt::print("{}\n", all.str());
}

void print_text(const BenchResult& r, const BenchArguments& options) {
  const double h = r.time_step_s;
  fmt::print("lab drum, {:.3g} m long, steady: {:.0f} balls, {:.0f} contact rows ({:.0f} press), {} thread\n",
             r.study.drum.length_m, r.balls, r.contacts, r.pressed, options.threads);
  fmt::print("time step {:.3g} ms ({:.0f} per contact search), {:.4g} iterations\n", 1e3 * h,
             r.study.solver.outer_step_s / h, r.quality.iterations);
  fmt::print("speed     {:.3f} s of a core per 1000 balls and simulated second ({:.2f} s for {:.2f} s)\n",
             r.cpu_s_per_1k_balls_per_sim_s(), r.cpu_s, r.simulated_s);
  fmt::print("solver    {:.1f} ns per contact row and iteration\n", r.ns_per_contact_iteration());
  double sum = 0;
  for (const double s : r.phase_s) sum += s;
  fmt::print("phases   ");
  for (std::size_t i = 0; i < phase_names.size(); ++i)
    fmt::print(" {} {:.1f} %", phase_names[i], 100 * r.phase_s[i] / sum);
  fmt::print("\nmemory    {:.0f} bytes a ball (state {:.0f}, scratch {:.0f}, wall {:.0f})\n",
             static_cast<double>(r.memory.total()) / r.balls, static_cast<double>(r.memory.state) / r.balls,
             static_cast<double>(r.memory.work) / r.balls, static_cast<double>(r.memory.wall) / r.balls);
  fmt::print("quality   residual {:.2e} m/s mean, overlap {:.2f} % of a diameter mean\nhash      {:016x}\n",
             r.quality.residual.mean, 100 * r.quality.mean_overlap, r.hash);
}

int bench(const BenchArguments& options) {
  if (options.threads < 1) throw InputError(fmt::format("--threads {}: accepted is 1 and more", options.threads));
  BenchOptions bench_options = options.bench;
  bench_options.threads = options.threads;
  Study study;  // the lab drum of S1 is what the defaults are
  study.outlet.opening_angle_deg = 0.2;
  if (options.setting == "s1") {
    study.solver.outer_step_s = 0.01;
    study.solver.sub_steps = 1;
    study.solver.iterations = 25;
  }
  if (!options.set.empty()) study = changed_study(study, options.set, "--set");
  Reporter reporter;
  const BenchResult result = run_bench(study, bench_options, [&](const Progress& p) {
    reporter.update(p, {});
    return true;
  });
  reporter.clear();
  options.json ? print_json(result, options) : print_text(result, options);
  return exit_done;
}

}  // namespace

void add_bench(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<BenchArguments>();
  CLI::App* command = app.add_subcommand("bench", "Measure this machine's speed on the steady lab drum, per phase.");
  command->add_option("--balls", options->bench.balls, "balls inside, about; set by the drum's length at equal load")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000000));
  command->add_option("--threads", options->threads, "threads for the one drum")->capture_default_str();
  command->add_option("--steps", options->bench.steps, "outer steps that are timed")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000000));
  command->add_option("--settle", options->bench.settle_turns, "turns before that")
      ->capture_default_str()
      ->check(number_between(0, 1000));
  command
      ->add_option("--setting", options->setting,
                   "s1: 10 ms x 25 iterations as in the paper; shipped: this program's default")
      ->capture_default_str()
      ->check(CLI::IsMember({"s1", "shipped"}));
  add_set_option(*command, options->set);
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Example:\n  drumsweep bench --balls 10000 --json\n"
      "  drumsweep bench --set effects.rolling_friction=0.1 --set solver.iterations=50\n"
      "Plan with it: core-hours = speed * balls / 1000 * simulated seconds * designs / 3600.");
  command->callback([options, &exit_code] { exit_code = bench(*options); });
}

}  // namespace drumsweep
