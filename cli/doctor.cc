/// drumsweep doctor
#include "sweep/doctor/doctor.h"

#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"

namespace drumsweep {
namespace {

struct DoctorArguments : DoctorOptions {
  bool json = false;
};

const char* level_name(Finding::Level level) {
  return level == Finding::Level::ok ? "ok" : level == Finding::Level::warning ? "warning" : "problem";
}

void print_json(const DoctorReport& report) {
  std::vector<std::string> findings;
  for (const Finding& f : report.findings)
    findings.push_back(JsonObject()
                           .text("level", level_name(f.level))
                           .text("subject", f.subject)
                           .text("text", f.text)
                           .text("advice", f.advice)
                           .str());
  fmt::print("{}\n", JsonObject()
                         .flag("usable", report.usable())
                         .count("ranks", report.ranks)
                         .number("durable_write_ms", report.write_ms)
                         .number("round_trip_us", report.round_trip_us)
                         .raw("findings", json_list(findings))
                         .str());
}

void print_text(const DoctorReport& report) {
  for (const Finding& f : report.findings) {
    fmt::print("{:<8} {:<14} {}\n", level_name(f.level), f.subject, f.text);
    if (!f.advice.empty()) fmt::print("{:<23} -> {}\n", "", f.advice);
  }
  fmt::print("{}\n", report.usable() ? "usable" : "NOT USABLE: see the problems above");
}

/// Several copies that do not know each other would all speak; their launcher has numbered them.
bool first_copy() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (const char* rank = std::getenv(name)) return std::string(rank) == "0";
  return true;
}

/// Open MPI would end the process with a page of text of its own.
void expect_pmi() {
  const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
  if (tasks == nullptr || std::string(tasks) == "1") return;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})
    if (std::getenv(name) != nullptr) return;
  throw std::runtime_error(fmt::format(
      "srun has started {} processes without PMIx, so they do not see each other: srun --mpi=pmix, or mpirun", tasks));
}

int doctor(const DoctorArguments& options) {
  DoctorReport report;
  try {
    expect_pmi();
    Farm farm;
    if (farm.rank() != 0) {
      // Rank 0 speaks for all.
      serve_examination(farm);
      return exit_done;
    }
    report = examine(farm, options);
  } catch (const std::exception& error) {
    if (!first_copy()) return exit_usage;
    report.findings = examine_surroundings(true);
    report.findings.insert(report.findings.begin(), {Finding::Level::problem, "ranks", error.what(),
                                                     "see cluster/README.md, \"When it does not start\""});
  }
  options.json ? print_json(report) : print_text(report);
  return report.usable() ? exit_done : exit_usage;
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorArguments>();
  CLI::App* command = app.add_subcommand("doctor", "Is this machine, this MPI, this file system fit for a sweep?");
  command->add_option("-o,--output", options->folder, "where results would go; need not exist")->capture_default_str();
  command->add_option("--threads", options->threads, "threads that each rank would use")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n"
      "  drumsweep doctor\n"
      "  mpirun -n 8 drumsweep doctor -o /scratch/me/out    the same way the sweep would be started\n"
      "Do the ranks see each other (or is each one alone)? CPUs against ranks and threads, binding, memory, free disk, "
      "time of\n"
      "a durable write, locks, whether all ranks see what rank 0 writes, time of a message, time left in a Slurm job,\n"
      "versions. Each line is ok, a warning, or a problem, with what to do about it. Nothing stays behind in the "
      "folder.\n"
      "Exit code 0: usable, 2: a sweep would fail.");
  command->callback([options, &exit_code] { exit_code = doctor(*options); });
}

}  // namespace drumsweep
