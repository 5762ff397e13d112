/// The drum that all designs start from, what the sweep has cost, and where its numbers come from.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <filesystem>
#include <map>
#include <set>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "postproc/picture.h"
#include "postproc/report/chart.h"
#include "postproc/report/html.h"
#include "sweep/progress.h"
#include "sweep/report/sections.h"
#include "sweep/report/wording.h"

namespace drumsweep {
namespace {

std::string picture_html(ReportData& data) {
  try {
    PictureOptions options;
    options.width = 1100;
    options.height = 700;
    const DrumModel model(data.study, warmup_outlet(data.study));
    const Still still = still_of(model, data.warm->state, model.belt_height);
    const std::string png = rendered(still, options, picture_frame(still, options), "");
    const std::string caption =
        fmt::format("The drum {}, cut open on the near side: {} balls, after {:.1f} s of simulated time.",
                    data.warm->finished ? "after its warm-up" : "as far as its warm-up has got",
                    data.warm->state.balls.size(), still.time_s);
    return figure(
        fmt::format("<img alt=\"Rendered picture of the drum and its balls\" width=\"{}\" height=\"{}\" src=\"{}\">",
                    options.width, options.height, data_url(png, "image/png")),
        caption, true);
  } catch (const std::exception& error) {
    const std::string why = error.what();
    data.notes.push_back("no picture of the drum: " + why);
    return fmt::format("<p class=\"note\">There is no picture of the drum here: {}.</p>\n", escaped(why));
  }
}

std::string steadiness_html(const ReportData& data) {
  if (!data.warm) return fmt::format("<p>{}</p>\n", escaped(data.warm_trouble));
  const WarmState& warm = *data.warm;
  const WarmupConfig& w = data.study.warmup;
  if (warm.windows.empty()) return "<p>The warm-up is under way; no window of it is complete.</p>\n";
  std::vector<ChartPoint> in, out, low, high;
  std::vector<double> flows;
  for (const WarmupWindow& window : warm.windows) {
    const double fed = static_cast<double>(window.fed), left = static_cast<double>(window.left);
    const auto tip = [&](const char* what, double value) {
      return fmt::format("turns {} to {}\n{} {:.0f} balls\n{} inside", plain(window.turns_end - w.window_turns),
                         plain(window.turns_end), what, value, window.inside);
    };
    in.push_back({window.turns_end, fed, 0, tip("fed", fed)});
    out.push_back({window.turns_end, left, 0, tip("left", left)});
    low.push_back({window.turns_end, fed * (1 - w.tolerance), 0, ""});
    high.push_back({window.turns_end, fed * (1 + w.tolerance), 0, ""});
    flows.insert(flows.end(), {fed, left});
  }
  ChartAxis turns =
      axis_over("turns since the empty drum", {warm.windows.front().turns_end, warm.windows.back().turns_end});
  Chart chart("Inflow and outflow of the warm-up", turns, axis_over("balls in a window", flows, true), 900, 280);
  chart.band(low, high, "a");
  chart.line(in, "a");
  chart.line(out, "b");
  chart.points(in, "a", "square");
  chart.points(out, "b", "circle");
  chart.legend(fmt::format("fed, ± {} %", plain(100 * w.tolerance)), "a", "square");
  chart.legend("left the drum", "b", "circle");
  const WarmupWindow& last = warm.windows.back();
  const double miss = last.fed > 0 ? 100 * (static_cast<double>(last.left) / static_cast<double>(last.fed) - 1) : 0;
  const std::string verdict =
      warm.steady ? fmt::format(
                        "<b class=\"pass\">The drum is steady</b>: in {} of {} turns in a row as many balls "
                        "left as were fed, within {} % (last: {:+.1f} %)",
                        counted(static_cast<std::size_t>(w.windows), "window"), plain(w.window_turns),
                        plain(100 * w.tolerance), miss)
      : warm.finished ? fmt::format(
                            "<b class=\"fail\">The drum was not steady</b> when its warm-up ended at {} turns (last "
                            "window: {:+.1f} %), so no result is to be trusted",
                            plain(w.max_turns), miss)
                      : "The warm-up is not finished";
  return fmt::format(
      "<p>{}. It held {} balls after {} turns.</p>\n{}", verdict, last.inside, plain(last.turns_end),
      figure(chart.svg(), "Balls fed and balls that left, by window; the band is the study’s tolerance.", true));
}

/// One bar a design, one row a rank.
std::string gantt(const RunTimeline& run, std::size_t number) {
  constexpr std::size_t most_ranks = 48;
  std::vector<const RankTimeline*> ranks;
  for (const RankTimeline& rank : run.ranks) ranks.push_back(&rank);
  const bool cut = ranks.size() > most_ranks;
  if (cut) {
    std::stable_sort(ranks.begin(), ranks.end(), [](auto* a, auto* b) { return a->idle_share > b->idle_share; });
    ranks.resize(most_ranks);
  }
  ChartAxis rows{"rank", -0.6, static_cast<double>(ranks.size()) - 0.4, {}};
  for (const RankTimeline* rank : ranks) rows.names.push_back(fmt::format("{}", rank->rank));
  const bool minutes = run.wall_s > 300, hours = run.wall_s > 18000;
  const double unit = hours ? 3600 : minutes ? 60 : 1;
  Chart chart(fmt::format("What every rank did in run {}", number),
              {fmt::format("time since the run began ({})", hours     ? "h"
                                                            : minutes ? "min"
                                                                      : "s"),
               0, std::max(1e-3, run.wall_s / unit)},
              rows, 900, 82 + 18 * static_cast<double>(ranks.size()) + 24);
  for (std::size_t k = 0; k < ranks.size(); ++k) {
    std::size_t designs = 0;
    for (const TimelineSpan& span : ranks[k]->spans) {
      const bool warm = span.kind == TimelineSpan::Kind::warm_up;
      const std::string css = warm                                         ? "b"
                              : span.event == "done" || span.event.empty() ? (designs++ % 2 == 0 ? "a" : "grey")
                                                                           : "bad";
      chart.bar(
          span.begin_s / unit, span.end_s / unit, static_cast<double>(k) - 0.38, static_cast<double>(k) + 0.38, css,
          warm ? fmt::format("warm-up, {:.1f} s", span.end_s - span.begin_s)
               : fmt::format("{} on rank {}, {:.1f} s{}", span.design_id, ranks[k]->rank, span.end_s - span.begin_s,
                             span.event == "done" ? ""
                             : span.event.empty() ? ", no end"
                                                  : ", " + span.event));
    }
  }
  chart.legend("", "a", "bar");
  chart.legend("designs, in turn", "grey", "bar");
  chart.legend("warm-up", "b", "bar");
  chart.legend("failed or stopped", "bad", "bar");
  return figure(
      chart.svg(),
      fmt::format("Run {} of {}: {} on {}, idle {} % of the time of designs{}.", number, escaped(run.begin_utc),
                  clock_text(run.wall_s), counted(run.ranks.size(), "rank"), plain(100 * run.idle_share, 2),
                  cut ? fmt::format("; the {} ranks with the most idle time", most_ranks) : ""),
      true);
}

std::string checksum_of(const std::string& path) {
  try {
    const std::string bytes = read_whole_file(path);
    return fmt::format("<code>{:08x}</code>, {} bytes",
                       crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()), bytes.size());
  } catch (const std::exception&) {
    return "not there";
  }
}

}  // namespace

std::string drum_html(ReportData& data, bool picture) {
  std::string html = steadiness_html(data);
  if (data.warm && picture) html = picture_html(data) + html;
  return html;
}

std::string cost_html(const ReportData& data) {
  const SweepStatus& s = data.status;
  if (s.timeline.empty()) return "<p>No run yet.</p>\n";
  std::vector<double> cpu;
  std::size_t lost = 0, crashed = 0;
  double warm_up = 0;
  for (const ProvenanceLine& line : data.provenance) {
    if (line.event == "done") cpu.push_back(line.cpu_s);
    if (line.event == "warm_up") warm_up += line.cpu_s;
    lost += line.event == "lost" ? 1 : 0;
    crashed += line.event == "crashed" ? 1 : 0;
  }
  std::vector<std::pair<std::string, std::string>> facts = {{"all", core_time(s.cpu_s)},
                                                            {"warm-up", core_time(warm_up)}};
  if (!cpu.empty())
    facts.emplace_back("a design", fmt::format("{} (5 to 95 %: {:.3g} to {:.3g} s)", core_time(quantile(cpu, 0.5)),
                                               quantile(cpu, 0.05), quantile(cpu, 0.95)));
  if (lost + crashed > 0)
    facts.emplace_back("attempts lost",
                       fmt::format("{} with their process, {} by a crash of their own", lost, crashed));

  HtmlTable table{{{"run"},
                   {"began (UTC)"},
                   {"ranks", true},
                   {"wall time", true},
                   {"warm-up (s)", true},
                   {"designs", true},
                   {"idle (%)", true},
                   {"tail (s)", true},
                   {"end"}},
                  {},
                  false,
                  0};
  for (std::size_t k = 0; k < s.timeline.size(); ++k) {
    const RunTimeline& run = s.timeline[k];
    table.rows.push_back({{fmt::format("{}", k + 1), ""},
                          {escaped(run.begin_utc), ""},
                          {fmt::format("{}", run.ranks.size()), ""},
                          {clock_text(run.wall_s), ""},
                          {plain(run.warm_up_s, 3), ""},
                          {fmt::format("{}", run.designs), ""},
                          {plain(100 * run.idle_share, 2), ""},
                          {plain(run.tail_s, 2), ""},
                          {run.active    ? "going on"
                           : run.orderly ? "in good order"
                                         : "killed (to its last trace)",
                           ""}});
  }
  std::string html = fact_table(facts) + html_of(table);

  // The runs that did most.
  constexpr std::size_t most_runs = 3;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < s.timeline.size(); ++k)
    if (s.timeline[k].designs > 0) order.push_back(k);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return s.timeline[a].designs > s.timeline[b].designs; });
  if (order.size() > most_runs) order.resize(most_runs);
  std::sort(order.begin(), order.end());
  for (const std::size_t k : order) html += gantt(s.timeline[k], k + 1);
  return html;
}

std::string provenance_html(const ReportData& data) {
  std::map<std::string, std::size_t> hosts;
  std::set<std::string> versions;
  std::string begin, end;
  int ranks = 1;
  for (const ProvenanceLine& line : data.provenance) {
    if (!line.host.empty() && line.event == "done") ++hosts[line.host];
    if (!line.program_version.empty()) versions.insert(line.program_version);
    if (begin.empty()) begin = line.time_utc;
    if (!line.time_utc.empty()) end = line.time_utc;
    ranks = std::max(ranks, line.ranks);
  }
  std::string host_list;
  for (const auto& [host, designs] : hosts)
    host_list += fmt::format("{}{} ({})", host_list.empty() ? "" : ", ", escaped(host), counted(designs, "design"));
  std::error_code error;
  const std::string folder = std::filesystem::absolute(data.folder, error).lexically_normal().string();
  std::vector<std::pair<std::string, std::string>> facts = {
      {"program",
       escaped(fmt::format("drumsweep {}{}", DRUMSWEEP_VERSION,
                           versions.size() > 1 ? fmt::format("; the runs: {}", fmt::join(versions, ", ")) : ""))},
      {"folder", fmt::format("<code>{}</code>", escaped(folder))},
      {"seed", fmt::format("{}", data.study.seed)},
      {"simulated on", host_list.empty() ? "–" : host_list},
      {"from, to (UTC)", begin.empty() ? "–" : escaped(begin + " to " + end)},
      {"CRC-32 of study.toml", checksum_of(data.paths.study())},
      {"CRC-32 of results.csv", checksum_of(data.paths.results())},
      {"CRC-32 of findings.toml", checksum_of(data.paths.findings())}};
  if (data.best)
    facts.emplace_back("state hash of the shown design",
                       fmt::format("<code>{}</code>", escaped(data.best->row.state_hash)));
  std::string html = fact_table(facts);
  html += fmt::format(
      "<h3>Do it again</h3>\n<p>The same study, seed and program version give the same <code>results.csv</code> bit "
      "for bit, for "
      "any number of ranks. Save the study file above as <code>study.toml</code>, or take it from the folder:</p>\n"
      "<pre>mpirun -n {} drumsweep run study.toml -o again\ncmp again/results.csv {}/results.csv</pre>\n",
      ranks, escaped(folder));
  if (!data.status.finished)
    html += fmt::format("<p>To go on with this sweep:</p>\n<pre>mpirun -n {} drumsweep run {}/study.toml -o {}</pre>\n",
                        ranks, escaped(folder), escaped(folder));
  return html;
}

}  // namespace drumsweep
