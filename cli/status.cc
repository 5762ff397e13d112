/// drumsweep status
#include "sweep/status.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "sweep/progress.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

struct StatusArguments {
  std::string folder;
  bool json = false, watch = false, timeline = false;
};

constexpr std::chrono::seconds watch_interval{2};

std::int64_t count(std::size_t n) { return static_cast<std::int64_t>(n); }

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

std::string timeline_as_json(const std::vector<RunTimeline>& timeline) {
  std::vector<std::string> runs;
  for (const RunTimeline& run : timeline) {
    std::vector<std::string> shares;
    for (const RankTimeline& rank : run.ranks) shares.push_back(json_number(rank.idle_share));
    JsonObject object;
    object.text("begin", run.begin_utc).number("wall_s", run.wall_s).count("ranks", count(run.ranks.size()));
    object.number("idle_share", run.idle_share).number("idle_s", run.idle_s).number("tail_s", run.tail_s);
    object.number("warm_up_s", run.warm_up_s).number("designs_s", run.designs_s).count("designs", count(run.designs));
    object.flag("active", run.active).flag("killed", !run.orderly).raw("idle_share_of_ranks", json_list(shares));
    runs.push_back(object.str());
  }
  return JsonObject().raw("runs", json_list(runs)).str();
}

std::string json_of(const SweepStatus& s, bool timeline) {
  JsonObject state, all;
  state.count("pending", count(s.state.pending)).count("running", count(s.state.running));
  state.count("done", count(s.state.done)).count("untrusted", count(s.state.untrusted));
  state.count("failed", count(s.state.failed))
      .count("lost", count(s.state.lost))
      .count("stopped", count(s.state.stopped));
  all.raw("state", state.str()).flag("finished", s.finished).number("cpu_s", s.cpu_s).raw("best", best_as_json(s));
  std::vector<std::string> stages;
  for (const StageStatus& stage : s.stages)
    stages.push_back(JsonObject()
                         .text("name", stage.name)
                         .text("type", stage.type)
                         .count("designs", count(stage.designs))
                         .count("ended", count(stage.ended))
                         .flag("complete", stage.complete)
                         .str());
  all.raw("stages", json_list(stages));
  all.count("designs", count(s.total)).flag("active", s.active).text("phase", s.phase);
  if (timeline) all.raw("timeline", timeline_as_json(s.timeline));
  return all.str() + "\n";
}

/// Columns of the terminal on standard output; 100 where there is none.
std::size_t columns_of_output() {
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 100;
}

std::string timeline_as_text(const std::vector<RunTimeline>& timeline) {
  if (timeline.empty()) return "timeline   no run yet\n";
  std::string text;
  for (const RunTimeline& run : timeline) {
    text += fmt::format("run of {}: {} on {} rank{}{}\n", run.begin_utc, clock_text(run.wall_s), run.ranks.size(),
                        run.ranks.size() == 1 ? "" : "s",
                        run.active     ? ", going on"
                        : !run.orderly ? ", killed (to its last trace)"
                                       : "");
    text += fmt::format(
        "  warm-up {:.1f} s; {} designs in {:.1f} s, ranks idle {:.1f} % of that ({:.1f} s), tail {:.1f} s\n",
        run.warm_up_s, run.designs, run.designs_s, 100 * run.idle_share, run.idle_s, run.tail_s);
    text += chart_of(run, columns_of_output());
  }
  return text + " rank w warm-up, # and = designs in turn, . waiting; busy: of the time of designs\n";
}

std::string text_of(const std::string& folder, const SweepStatus& s, bool timeline) {
  const std::size_t ended = s.state.done + s.state.untrusted + s.state.failed;
  std::string text = fmt::format("{}: {}{}\n", folder,
                                 s.finished ? "finished"
                                 : s.active ? "running"
                                            : "not finished, no run is going on",
                                 s.phase.empty() ? "" : " (" + s.phase + ")");
  text += fmt::format("designs    {} of {} have ended: {} done, {} untrusted, {} failed\n", ended, s.total,
                      s.state.done, s.state.untrusted, s.state.failed);
  text += fmt::format("open       {} never begun, {} running, {} stopped, {} lost with their process\n",
                      s.state.pending, s.state.running, s.state.stopped, s.state.lost);
  if (s.stages.size() > 1)
    for (const StageStatus& stage : s.stages)
      text += fmt::format("stage      \"{}\" ({}): {} of {}{}\n", stage.name, stage.type, stage.ended, stage.designs,
                          stage.complete ? "" : ", it will ask for more when earlier results are there");
  text += fmt::format("cpu time   {}\n", clock_text(s.cpu_s));
  if (s.best) {
    text += fmt::format("best       {}", s.best->design_id);
    for (std::size_t i = 0; i < s.variable_names.size(); ++i)
      text += fmt::format(", {} = {}", s.variable_names[i], s.best->variables.at(i));
    text += fmt::format(": f = {:.4g} +- {:.2g} m{}\n", s.best->f_m, s.best->sigma_f_m,
                        s.best->state == "untrusted" ? " (UNTRUSTED: " + s.best->reason + ")" : "");
  }
  return timeline ? text + timeline_as_text(s.timeline) : text;
}

/// Puts a block over the one before on a terminal.
void redraw(const std::string& before, const std::string& text) {
  const auto lines = std::count(before.begin(), before.end(), '\n');
  if (lines > 0) fmt::print("\033[{}F\033[J", lines);
  fmt::print("{}", text);
}

void status(const StatusArguments& options) {
  const bool terminal = !options.json && ::isatty(STDOUT_FILENO) != 0;
  if (options.watch) install_stop_signals();
  std::string before;
  while (true) {
    const SweepStatus s = read_status(options.folder);
    const std::string text = options.json ? json_of(s, options.timeline) : text_of(options.folder, s, options.timeline);
    if (terminal)
      redraw(before, text);
    else if (text != before)
      fmt::print("{}", text);
    before = text;
    if (std::fflush(stdout) != 0 || !options.watch || s.finished || !s.active) return;
    for (auto waited = std::chrono::milliseconds(0); waited < watch_interval; waited += std::chrono::milliseconds(50)) {
      if (stop_requested()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
}

}  // namespace

void add_status(CLI::App& app, int&) {
  auto options = std::make_shared<StatusArguments>();
  CLI::App* command = app.add_subcommand("status", "How far a sweep is; works while it runs and changes nothing.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command->add_flag("--json", options->json, "one JSON object on standard output (with --watch: one a line)");
  command->add_flag("--watch", options->watch,
                    "again every 2 s until the sweep has finished or no run is going on; in place on a terminal, "
                    "elsewhere one block a change");
  command->add_flag("--timeline", options->timeline, "what every rank did when, and how long ranks were idle");
  command->footer(
      "Examples:\n  drumsweep status out --json\n  drumsweep status out --watch --timeline\n"
      "Counts of designs by state, CPU time so far [s], the best design (lowest f [m]).");
  command->callback([options] { status(*options); });
}

}  // namespace drumsweep
