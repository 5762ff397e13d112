/// drumsweep run
#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "sweep/stop.h"
#include "sweep/store/results.h"
#include "sweep/sweep.h"

namespace drumsweep {
namespace {

int run(const SweepOptions& options) {
  Farm farm;
  install_stop_signals();
  if (farm.rank() != 0) {
    // Rank 0 speaks for all, with the exit code too.
    serve_sweep(farm, options.threads);
    return exit_done;
  }
  const SweepOutcome outcome = run_sweep(farm, options);
  if (const auto best = best_row(outcome.table.rows)) {
    const ResultRow& row = outcome.table.rows[*best];
    fmt::print("lowest f of a single run: {} (stage {})", row.design_id, row.stage);
    for (std::size_t i = 0; i < row.variables.size(); ++i)
      fmt::print(", {} = {}", outcome.table.variable_names[i], row.variables[i]);
    fmt::print("\n  f = {:.4g} +- {:.2g} m{}\n", row.f_m, row.sigma_f_m,
               row.state == "done" ? "" : ", UNTRUSTED: " + row.reason);
  }
  if (outcome.findings) fmt::print("{}", describe(*outcome.findings));
  fmt::print("table: {}/results.csv\n", outcome.output);
  if (!outcome.finished) {
    fmt::print(stderr, "drumsweep: stopped early: {}\n", outcome.stop_cause);
    return exit_stopped;
  }
  fmt::print("figure: drumsweep contour {} -o contour.png\n", outcome.output);
  return outcome.failed > 0 ? exit_some_failed : exit_done;
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command =
      app.add_subcommand("run", "Run a study: warm-up if missing, all stages, table. Run again to go on.");
  command->add_option("STUDY", options->study_path, "study file (TOML)")->required();
  command->add_option("-o,--output", options->output, "output folder [default: STUDY's name + _result, here]");
  command
      ->add_option("--threads", options->threads,
                   "threads of each rank; more ranks are better unless there are fewer designs than cores")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  command->footer(
      "Examples:\n"
      "  drumsweep run study/quick.toml -o out              on one core\n"
      "  mpirun -n 8 drumsweep run study/quick.toml -o out  on eight, one design each at a time\n"
      "Every design is stored when it is done; after a kill or Ctrl-C the same command goes on. The table is the same "
      "bit\n"
      "for bit for any number of ranks and interruptions. In OUT: results.csv (f_m in metres, one row a design),\n"
      "provenance.csv (who, where, how long), run.log, warm_state.h5, designs/ID.h5 (landings).\n"
      "Changed stages and [objective] keys are taken up, without simulating anything twice; any other change is "
      "refused\n"
      "(exit 5). SIGINT, SIGTERM and SIGUSR2 stop within a step (exit 3).");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace drumsweep
