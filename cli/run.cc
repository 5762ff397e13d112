/// drumsweep run
#include <fmt/format.h>

#include <memory>
#include <sstream>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/config/schema.h"
#include "sweep/farm/crash_note.h"
#include "sweep/stop.h"
#include "sweep/store/results.h"
#include "sweep/sweep.h"

namespace drumsweep {
namespace {

/// "1:30:00", "90:00" or "5400" in seconds. @throws InputError
double seconds_of_clock(const std::string& text) {
  double seconds = 0;
  int parts = 0;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ':'); ++parts) {
    std::size_t used = 0;
    double value = -1;
    try {
      value = std::stod(part, &used);
    } catch (const std::exception&) {
    }
    if (used != part.size() || !(value >= 0) || parts > 2 || (parts > 0 && value >= 60)) {
      parts = 0;
      break;
    }
    seconds = 60 * seconds + value;
  }
  if (parts == 0 || !(seconds > 0))
    throw InputError("--stop-before " + text + ": accepted is HH:MM:SS, MM:SS or seconds, above 0");
  return seconds;
}

void set_retry(const std::vector<std::string>& states, SweepOptions& options) {
  for (const std::string& state : states) (state == "failed" ? options.retry_failed : options.retry_lost) = true;
}

int run(const SweepOptions& options) {
  Farm farm;
  install_stop_signals();
  install_crash_handler();
  if (farm.rank() != 0) {
    // Rank 0 speaks for all, with the exit code too.
    serve_sweep(farm, options);
    return exit_done;
  }
  const SweepOutcome outcome = run_sweep(farm, options);
  if (const auto best = best_row(outcome.table.rows)) {
    const ResultRow& row = outcome.table.rows[*best];
    fmt::print("lowest f of a single run: {} (stage {})", row.design_id, row.stage);
    for (std::size_t i = 0; i < row.variables.size(); ++i)
      fmt::print(", {} = {}", outcome.table.variable_names[i], row.variables[i]);
    fmt::print("\n  f = {:.4g} +- {:.2g} m, largest |a_n| / a_0 = {:.3g} (S1's stop test asks for 0.1){}\n", row.f_m,
               row.sigma_f_m, row.max_an_over_a0, row.state == "done" ? "" : ", UNTRUSTED: " + row.reason);
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
  add_set_option(*command, options->changes);
  command
      ->add_option("--threads", options->threads,
                   "threads of each rank; more ranks are better unless there are fewer designs than cores")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  auto stop_before = std::make_shared<std::string>();
  auto retry = std::make_shared<std::vector<std::string>>();
  command->add_option("--stop-before", *stop_before,
                      "HH:MM:SS (or seconds) after the start: stop in good order before this, exit 3; for job scripts");
  command
      ->add_option(
          "--checkpoint", options->checkpoint_interval_s,
          "seconds between checkpoints inside a design (at a turn's end, at most 1 % of the time); 0: every turn")
      ->capture_default_str()
      ->check(number_between(0, 1e6));
  command
      ->add_option(
          "--retry", *retry,
          "failed: try designs again that have failed; lost: those in quarantine, whose process died every time")
      ->delimiter(',')
      ->check(CLI::IsMember({"failed", "lost"}));
  command
      ->add_option(
          "--hang", options->hang_s,
          "a rank whose engine takes longer than so many seconds for one outer step is ended as if it had crashed; "
          "0: never")
      ->capture_default_str()
      ->check(number_between(0, 1e6));
  command->add_flag("--dedicated-master,!--no-dedicated-master", options->dedicated_master,
                    "rank 0 only serves the others, or simulates too [default: only serves above 32 ranks]");
  command->add_flag("--survive", options->survive,
                    "go on when a rank dies; with mpirun --enable-recovery --mca orte_abort_on_non_zero_status 0");
  command
      ->add_option(
          "--silence", options->silence_s,
          "--survive: a rank that was not heard for so many seconds is taken for dead (on the host of rank 0 it "
          "is seen at once)")
      ->capture_default_str()
      ->check(number_between(1, 1e5));
  command->footer(
      "Examples:\n"
      "  drumsweep run study/quick.toml -o out              on one core\n"
      "  mpirun -n 8 drumsweep run study/quick.toml -o out  on eight, one design each at a time\n"
      "Every design is stored when it is done; after a kill or Ctrl-C the same command goes on. The table is the same "
      "bit\n"
      "for bit for any number of ranks and interruptions. In OUT: results.csv (f_m in metres, one row a design),\n"
      "provenance.csv (who, where, how long), run.log, warm_state.h5, designs/ID.h5 (landings).\n"
      "With --set each set of values needs a folder of its own; `drumsweep compare` puts such folders side by side.\n"
      "Changed stages and [objective] keys are taken up, without simulating anything twice; any other change is "
      "refused\n"
      "(exit 5). SIGINT, SIGTERM and SIGUSR2 stop within a step, with a checkpoint (exit 3); SIGUSR1 writes one and "
      "goes "
      "on.\n"
      "A design that crashes its process twice is put into quarantine: see OUT/quarantine; a hang counts as a crash.");
  command->callback([options, stop_before, retry, &exit_code] {
    if (!stop_before->empty()) options->stop_before_s = seconds_of_clock(*stop_before);
    set_retry(*retry, *options);
    exit_code = run(*options);
  });
}

}  // namespace drumsweep
