#include "sweep/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace drumsweep {
namespace {

constexpr std::size_t most_rows = 64;

/// A design that a rank is at, while the lines are read.
struct Open {
  std::string design_id;
  double begin_s;
};

RankTimeline& rank_of(RunTimeline& run, int rank) {
  while (run.ranks.size() <= static_cast<std::size_t>(std::max(0, rank))) {
    run.ranks.emplace_back();
    run.ranks.back().rank = static_cast<int>(run.ranks.size()) - 1;
  }
  return run.ranks[static_cast<std::size_t>(std::max(0, rank))];
}

/// Shares and sums, once all spans are there. @param first_s  of the first design, NaN where there was none
void sum_up(RunTimeline& run, double first_s) {
  if (std::isnan(first_s)) return;
  run.designs_s = run.wall_s - first_s;
  double first_free_s = run.wall_s;
  for (RankTimeline& rank : run.ranks) {
    double last_s = first_s;
    for (const TimelineSpan& span : rank.spans) {
      if (span.kind != TimelineSpan::Kind::design) continue;
      rank.busy_s += span.end_s - span.begin_s;
      last_s = std::max(last_s, span.end_s);
      ++run.designs;
    }
    first_free_s = std::min(first_free_s, last_s);
    rank.idle_share = run.designs_s > 0 ? std::clamp(1 - rank.busy_s / run.designs_s, 0.0, 1.0) : 0;
    run.idle_s += std::max(0.0, run.designs_s - rank.busy_s);
  }
  run.tail_s = run.wall_s - first_free_s;
  if (run.designs_s > 0) run.idle_share = run.idle_s / (run.designs_s * static_cast<double>(run.ranks.size()));
}

/// One run: the lines from its run_begin up to the next one's.
RunTimeline run_of(const ProvenanceLine* begin, const ProvenanceLine* end, bool active, double now) {
  RunTimeline run;
  run.begin_utc = begin->time_utc;
  const double begin_s = seconds_of(begin->time_utc);
  rank_of(run, begin->ranks - 1);
  double first_s = std::numeric_limits<double>::quiet_NaN();
  std::map<int, Open> open;
  const auto close = [&](int rank, double at_s, double wall_s, const std::string& event) {
    const auto found = open.find(rank);
    if (found == open.end()) return;
    const double from_s = wall_s > 0 ? std::max(found->second.begin_s, at_s - wall_s) : found->second.begin_s;
    rank_of(run, rank).spans.push_back({TimelineSpan::Kind::design, from_s, at_s, found->second.design_id, event});
    open.erase(found);
  };

  run.orderly = active;
  double last_s = 0;
  for (const ProvenanceLine* line = begin; line != end; ++line) {
    const double at_s = seconds_of(line->time_utc) - begin_s;
    if (std::isnan(at_s)) continue;
    last_s = std::max(last_s, at_s);
    if (!line->host.empty()) rank_of(run, line->rank).host = line->host;
    if (line->event == "run_end") run.orderly = true;
    if (line->event == "warm_up") {
      rank_of(run, line->rank)
          .spans.push_back({TimelineSpan::Kind::warm_up, std::max(0.0, at_s - line->wall_s), at_s, "", ""});
      run.warm_up_s += line->wall_s;
    }
    if (line->design_id.empty()) continue;
    if (line->event == "started") {
      close(line->rank, at_s, 0, "");
      open[line->rank] = {line->design_id, at_s};
      if (std::isnan(first_s)) first_s = at_s;
    } else if (const auto at = open.find(line->rank); at != open.end() && at->second.design_id == line->design_id) {
      close(line->rank, at_s, line->wall_s, line->event);
    }
  }
  run.active = active;
  run.wall_s = active ? std::max(last_s, now - begin_s) : last_s;
  while (!open.empty()) close(open.begin()->first, run.wall_s, 0, "");
  sum_up(run, first_s);
  return run;
}

/// What a rank did in most of each of `columns` equal pieces of the run.
std::string bar_of(const RunTimeline& run, const RankTimeline& rank, std::size_t columns) {
  const double step = run.wall_s / static_cast<double>(columns);
  std::string bar(columns, '.');
  std::vector<double> covered(columns), longest(columns);
  std::size_t designs = 0;
  for (const TimelineSpan& span : rank.spans) {
    const bool design = span.kind == TimelineSpan::Kind::design;
    const char mark = !design ? 'w' : designs++ % 2 == 0 ? '#' : '=';
    const auto last = std::min(columns - 1, static_cast<std::size_t>(std::max(0.0, span.end_s / step)));
    for (auto i = static_cast<std::size_t>(std::max(0.0, span.begin_s / step)); i <= last; ++i) {
      const double left = static_cast<double>(i) * step;
      const double share = std::min(span.end_s, left + step) - std::max(span.begin_s, left);
      covered[i] += std::max(0.0, share);
      if (share > longest[i] && covered[i] >= 0.5 * step) bar[i] = mark;
      longest[i] = std::max(longest[i], share);
    }
  }
  return bar;
}

}  // namespace

std::vector<RunTimeline> timeline_of(const std::vector<ProvenanceLine>& lines, bool active, double now) {
  std::vector<RunTimeline> runs;
  const ProvenanceLine* const end = lines.data() + lines.size();
  const auto begins = [](const ProvenanceLine& line) { return line.event == "run_begin"; };
  for (const ProvenanceLine* at = std::find_if(lines.data(), end, begins); at != end;) {
    const ProvenanceLine* const next = std::find_if(at + 1, end, begins);
    runs.push_back(run_of(at, next, active && next == end, now));
    at = next;
  }
  return runs;
}

std::string chart_of(const RunTimeline& run, std::size_t columns) {
  std::vector<const RankTimeline*> rows;
  for (const RankTimeline& rank : run.ranks) rows.push_back(&rank);
  if (rows.size() > most_rows) {
    std::stable_sort(rows.begin(), rows.end(), [](auto* a, auto* b) { return a->idle_share > b->idle_share; });
    rows.resize(most_rows);
  }
  std::string text;
  for (const RankTimeline* rank : rows) {
    const std::string label = fmt::format("{:>5} ", rank->rank);
    const std::string share =
        run.designs_s > 0 ? fmt::format(" {:5.1f} % busy", 100 * (1 - rank->idle_share)) : "  no designs";
    const std::size_t width = std::max<std::size_t>(10, columns - std::min(columns, label.size() + share.size() + 1));
    text += label + (run.wall_s > 0 ? bar_of(run, *rank, width) : "") + share + "\n";
  }
  if (rows.size() < run.ranks.size())
    text += fmt::format("      ... and {} ranks with less idle time\n", run.ranks.size() - rows.size());
  return text;
}

}  // namespace drumsweep
