/// drumsweep status
#include "sweep/status.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/json.h"
#include "sweep/progress.h"

namespace drumsweep {
namespace {

struct Options {
  std::string folder;
  bool json = false;
};

std::string best_as_json(const SweepStatus& s) {
  if (!s.best) return "null";
  JsonObject object;
  object.text("design_id", s.best->design_id).text("stage", s.best->stage).text("state", s.best->state);
  for (std::size_t i = 0; i < s.variable_names.size(); ++i) object.number(s.variable_names[i], s.best->variables.at(i));
  object.number("f_m", s.best->f_m)
      .number("sigma_f_m", s.best->sigma_f_m)
      .number("f_footprint_m", s.best->f_footprint_m);
  return object.str();
}

void print_json(const SweepStatus& s) {
  const auto count = [](std::size_t n) { return static_cast<std::int64_t>(n); };
  JsonObject state, all;
  state.count("pending", count(s.state.pending)).count("running", count(s.state.running));
  state.count("done", count(s.state.done)).count("untrusted", count(s.state.untrusted));
  state.count("failed", count(s.state.failed))
      .count("lost", count(s.state.lost))
      .count("stopped", count(s.state.stopped));
  all.raw("state", state.str()).flag("finished", s.finished).number("cpu_s", s.cpu_s).raw("best", best_as_json(s));
  all.count("designs", count(s.total)).flag("active", s.active).text("phase", s.phase);
  fmt::print("{}\n", all.str());
}

void print_text(const std::string& folder, const SweepStatus& s) {
  const std::size_t ended = s.state.done + s.state.untrusted + s.state.failed;
  fmt::print("{}: {}{}\n", folder,
             s.finished ? "finished"
             : s.active ? "running"
                        : "not finished, no run is going on",
             s.phase.empty() ? "" : " (" + s.phase + ")");
  fmt::print("designs    {} of {} have ended: {} done, {} untrusted, {} failed\n", ended, s.total, s.state.done,
             s.state.untrusted, s.state.failed);
  fmt::print("open       {} never begun, {} running, {} stopped, {} lost with their process\n", s.state.pending,
             s.state.running, s.state.stopped, s.state.lost);
  fmt::print("cpu time   {}\n", clock_text(s.cpu_s));
  if (s.best) {
    fmt::print("best       {}", s.best->design_id);
    for (std::size_t i = 0; i < s.variable_names.size(); ++i)
      fmt::print(", {} = {}", s.variable_names[i], s.best->variables.at(i));
    fmt::print(": f = {:.4g} +- {:.2g} m{}\n", s.best->f_m, s.best->sigma_f_m,
               s.best->state == "untrusted" ? " (UNTRUSTED: " + s.best->reason + ")" : "");
  }
}

}  // namespace

void add_status(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("status", "How far a sweep is; works while it runs and changes nothing.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Example:\n  drumsweep status out --json\n"
      "Counts of designs by state, CPU time so far [s], the best design (lowest f [m]).");
  command->callback([options] {
    const SweepStatus status = read_status(options->folder);
    if (options->json)
      print_json(status);
    else
      print_text(options->folder, status);
  });
}

}  // namespace drumsweep
