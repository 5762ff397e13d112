/// The subcommands. Each adds itself to the program; when it was the one asked for, it runs and sets the exit code.
/// Errors are thrown and become exit codes in main.cc:
///   0 done, 2 bad usage or input, 3 stopped early and resumable, 4 finished with failed designs,
///   5 refused (does not match what is stored), 6 another run holds the output.
#pragma once

#include <CLI/CLI.hpp>

namespace drumsweep {

enum ExitCode {
  exit_done = 0,
  exit_usage = 2,
  exit_stopped = 3,
  exit_some_failed = 4,
  exit_mismatch = 5,
  exit_held = 6
};

void add_init(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_run(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_plan(CLI::App& app, int& exit_code);
void add_why(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_contour(CLI::App& app, int& exit_code);
void add_sample(CLI::App& app, int& exit_code);
void add_rescore(CLI::App& app, int& exit_code);
void add_compare(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
void add_picture(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_diagnose(CLI::App& app, int& exit_code);
void add_slurm(CLI::App& app, int& exit_code);
void add_doctor(CLI::App& app, int& exit_code);

}  // namespace drumsweep
