#include "sweep/plan/planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "core/config/schema.h"
#include "core/config/stages.h"
#include "sweep/fit/acquisition.h"
#include "sweep/fit/optimum.h"
#include "sweep/refine/nlopt_replay.h"

namespace drumsweep {
namespace {

double value_at(const PlannedDesign& design, const std::string& key, double otherwise) {
  for (const auto& [name, value] : design.values)
    if (name == key) return value;
  return otherwise;
}

std::string at_point(const Box& box, const Point& point) {
  std::string text;
  for (std::size_t i = 0; i < box.size(); ++i)
    text += fmt::format("{}{} = {:.6g}", i == 0 ? "" : ", ", box[i].key, point[i]);
  return text;
}

Design design_of(const Box& box, const Point& point) {
  Design design;
  for (std::size_t i = 0; i < box.size(); ++i) design.emplace_back(box[i].key, point[i]);
  return design;
}

/// Of more rows some are fitted, as the cost grows with the cube.
constexpr std::size_t most_rows_of_a_fit = 300;

/// Half of them are those of the points with the lowest f; as these alone would know neither the surface's range nor its
/// slopes, the others are spread evenly over the table: by a golden step, so that no line of a grid is left out.
std::set<Point> points_to_fit(const std::vector<Sample>& points) {
  std::vector<std::size_t> by_f(points.size()), spread(points.size());
  std::iota(by_f.begin(), by_f.end(), 0);
  std::iota(spread.begin(), spread.end(), 0);
  std::stable_sort(by_f.begin(), by_f.end(),
                   [&](std::size_t a, std::size_t b) { return points[a].f_m < points[b].f_m; });
  const auto turn = [](std::size_t i) { return std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0); };
  std::stable_sort(spread.begin(), spread.end(), [&](std::size_t a, std::size_t b) { return turn(a) < turn(b); });
  std::set<Point> kept;
  std::size_t count = 0;
  const auto keep = [&](const std::vector<std::size_t>& order, std::size_t most) {
    for (const std::size_t i : order) {
      if (kept.count(points[i].at) > 0) continue;
      const std::size_t with_these = count + static_cast<std::size_t>(points[i].count);
      if (with_these > most) return;
      kept.insert(points[i].at);
      count = with_these;
    }
  };
  keep(by_f, most_rows_of_a_fit / 2);
  keep(spread, most_rows_of_a_fit);
  return kept;
}

}  // namespace

Box search_box(const Study& study, std::size_t stage) {
  Box box;
  for (const StageVariable& v : search_ranges(study, stage)) box.push_back({v.key, v.from, v.to, v.resolution});
  return box;
}

std::size_t most_further_designs(const Study& study, const Plan& plan, std::size_t s) {
  const StageConfig& stage = study.stages.at(s);
  const StageSummary& summary = plan.stages.at(s);
  if (summary.complete) return 0;
  std::int64_t most = 1;
  if (stage.type == "zoom")
    for (std::size_t i = 0; i < search_box(study, s).size(); ++i) most *= stage.nodes;
  if (stage.type == "adaptive") most = stage.budget;
  if (stage.type == "refine") most = study.refine.starts * study.refine.max_evaluations;
  if (stage.type == "replicate") most = stage.designs * stage.replicates;
  return static_cast<std::size_t>(most) - std::min(static_cast<std::size_t>(most), summary.designs.size());
}

std::optional<Point> point_of(const Box& box, const Study& study, const Plan& plan, const PlannedDesign& design) {
  Point point(box.size());
  for (std::size_t k = 0; k < plan.keys.size(); ++k) {
    const std::string& key = plan.keys[k];
    if (is_measuring_key(key)) continue;
    const auto axis = std::find_if(box.begin(), box.end(), [&](const DesignAxis& a) { return a.key == key; });
    if (axis == box.end()) {
      // NaN on both sides: the angle is given in the other unit.
      const double own = get_number(study, key);
      if (design.row[k] != own && !(std::isnan(own) && std::isnan(design.row[k]))) return std::nullopt;
      continue;
    }
    // Written so that a NaN is outside.
    if (!(design.row[k] >= axis->low && design.row[k] <= axis->high)) return std::nullopt;
    point[static_cast<std::size_t>(axis - box.begin())] = design.row[k];
  }
  return point;
}

std::vector<Measurement> measurements_in(const Box& box, const Study& study, const Plan& plan, std::size_t end,
                                         const RowOf& row_of) {
  std::vector<Measurement> rows;
  for (const std::size_t i : table_order(plan)) {
    const PlannedDesign& design = plan.designs[i];
    if (design.stage_number >= end) continue;
    const ResultRow* row = row_of(design);
    if (row == nullptr || row->state != "done" || !std::isfinite(row->f_m)) continue;
    if (const auto point = point_of(box, study, plan, design))
      rows.push_back({*point, value_at(design, replicate_key, study.record.replicate), row->f_m, row->sigma_f_m});
  }
  return rows;
}

Fit fit_rows(const Box& box, const Study& study, const Plan& plan, std::size_t end, const RowOf& row_of) {
  Fit out;
  std::vector<Measurement> rows = measurements_in(box, study, plan, end, row_of);
  Pooled pooled = pool(box, rows);
  out.points = std::move(pooled.samples);
  out.noise = pooled.noise;
  if (rows.size() > most_rows_of_a_fit) {
    const std::set<Point> kept = points_to_fit(out.points);
    std::erase_if(rows, [&](const Measurement& row) { return kept.count(row.at) == 0; });
    std::erase_if(out.points, [&](const Sample& point) { return kept.count(point.at) == 0; });
  }
  const int num_rows = static_cast<int>(rows.size()), num_points = static_cast<int>(out.points.size());
  if (num_points < points_for_a_fit(box)) {
    out.gate = too_few_points(box, num_rows, num_points);
  } else {
    out.surface.emplace(box, std::move(rows));
    out.gate = gate(*out.surface);
  }
  return out;
}

/// One stage that searches. Everything it keeps is a function of study and results.
struct Planner::Search {
  Search(const Study& study_in, Plan& plan_in, std::size_t stage_in)
      : study(study_in), plan(plan_in), stage(stage_in), box(search_box(study_in, stage_in)) {}

  const Study& study;
  Plan& plan;
  std::size_t stage;
  Box box;
  bool begun = false;
  std::vector<Point> starts{};      ///< refine
  std::vector<std::string> ends{};  ///< refine (num_starts) why each has ended, empty while it goes on

  const StageConfig& config() const { return study.stages[stage]; }
  StageSummary& summary() const { return plan.stages[stage]; }
  void note(const std::string& text) const { summary().notes.push_back(text); }

  Fit fit(std::size_t end, const RowOf& row_of) const { return fit_rows(box, study, plan, end, row_of); }

  void add(const Point& point) const { add(point, study.record.replicate); }
  void add(const Point& point, double replicate, double turns = not_given) const {
    Design values = design_of(box, point);
    if (replicate != study.record.replicate) values.emplace_back(replicate_key, replicate);
    if (!std::isnan(turns)) values.emplace_back(turns_key, turns);
    add_design(plan, study, stage, std::move(values));
  }

  bool has_geometry(const Point& point) const {
    try {
      study_of_design(study, design_of(box, point));
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

  // --- zoom

  void zoom(const RowOf& row_of) {
    const Fit known = fit(stage, row_of);
    Point low, high;
    for (const DesignAxis& axis : box) {
      low.push_back(axis.low);
      high.push_back(axis.high);
    }
    if (known.gate.fit_is_usable()) {
      const Optimum best = optimum(*known.surface, study.seed);
      low = best.low;
      high = best.high;
      note(fmt::format("region: where the optimum of the fit lies with 95 %, around {}; {}", at_point(box, best.at),
                       known.gate.reason));
    } else if (known.points.size() >= 3) {
      // No fit to trust: the box that the best tenth spans, and one typical distance between designs around it.
      std::vector<Sample> best = known.points;
      std::stable_sort(best.begin(), best.end(), [](const Sample& a, const Sample& b) { return a.f_m < b.f_m; });
      best.resize(std::max<std::size_t>(3, known.points.size() / 10));
      const double per_axis =
          std::max(2.0, std::pow(static_cast<double>(known.points.size()), 1 / static_cast<double>(box.size())));
      for (std::size_t i = 0; i < box.size(); ++i) {
        const auto [least, most] = std::minmax_element(
            best.begin(), best.end(), [&](const Sample& a, const Sample& b) { return a.at[i] < b.at[i]; });
        const double spacing = (box[i].high - box[i].low) / (per_axis - 1);
        low[i] = least->at[i] - spacing;
        high[i] = most->at[i] + spacing;
      }
      note(fmt::format("region: that of the {} designs with the lowest f; {}", best.size(), known.gate.reason));
    } else {
      note(fmt::format("region: the whole range, as only {} earlier designs have a result there", known.points.size()));
    }

    StageConfig grid;
    for (std::size_t i = 0; i < box.size(); ++i) {
      const double more = std::max(config().margin * (high[i] - low[i]), 0.5 * box[i].resolution);
      const double from = std::max(box[i].low, low[i] - more), to = std::min(box[i].high, high[i] + more);
      grid.variables.push_back({box[i].key, from, to, config().nodes, {}});
      note(fmt::format("{}: {:.6g} to {:.6g}", box[i].key, from, to));
    }
    // Nodes on the lattice; where it is coarser than the grid, some fall together.
    std::vector<Point> nodes;
    for (const Design& node : nodes_of_stage(grid)) {
      Point& point = nodes.emplace_back();
      for (const auto& [key, value] : node) point.push_back(value);
      point = quantised(box, point);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const Point& node : nodes) add(node);
    summary().complete = true;
  }

  // --- adaptive

  void adaptive(const RowOf& row_of) {
    const auto budget = static_cast<std::size_t>(config().budget);
    const std::size_t spent = summary().designs.size();
    if (spent >= budget) {
      note(fmt::format("the budget of {} designs is spent", budget));
      summary().complete = true;
      return;
    }
    if (!begun) {
      begun = true;
      const std::size_t num_known = pool(box, measurements_in(box, study, plan, stage + 1, row_of)).samples.size();
      const std::vector<Point> spread = initial_points(budget, num_known);
      if (!spread.empty()) {
        // Each with a replicate number of its own: one replicate's shared error would look like the surface.
        for (std::size_t i = 0; i < spread.size(); ++i) add(spread[i], study.record.replicate + static_cast<double>(i));
        note(fmt::format("{} designs spread evenly over the ranges, beside {} earlier results", spread.size(),
                         num_known));
        return;
      }
    }
    const Fit known = fit(stage + 1, row_of);
    if (!known.surface) {
      note("ended: " + known.gate.reason);
      summary().complete = true;
      return;
    }
    const auto count = static_cast<int>(std::min(budget - spent, static_cast<std::size_t>(config().batch)));
    const Batch batch = next_batch(*known.surface, count, study.seed + static_cast<std::int64_t>(spent), {},
                                   [&](const Point& point) { return has_geometry(point); });
    if (!batch.runs.empty() && batch.batch_gain_m < config().least_gain_m) {
      note(
          fmt::format("ended after {} of {} designs: {} more would lower f at the optimum by {:.2g} m, less than "
                      "least_gain_m = {:g}",
                      spent, budget, batch.runs.size(), batch.batch_gain_m, config().least_gain_m));
      summary().complete = true;
      return;
    }
    note(fmt::format("after {} designs: {}", spent, batch.reason));
    for (const Proposal& run : batch.runs) add(run.at, run.replicate);
    if (batch.runs.empty()) summary().complete = true;
  }

  /// Evenly spread designs that the stage begins with; those that cannot be built are passed over.
  std::vector<Point> initial_points(std::size_t budget, std::size_t num_known) const {
    // A fit needs some; an adaptive stage that cannot fit would end with its budget unused.
    const auto wanted = static_cast<std::size_t>(std::max<std::int64_t>(config().initial, points_for_a_fit(box)));
    const std::size_t count = std::min(budget, wanted > num_known ? wanted - num_known : 0);
    std::vector<Point> out;
    for (const Point& point : space_filling(box, 4 * count, study.seed))
      if (out.size() < count && has_geometry(point)) out.push_back(point);
    return out;
  }

  // --- refine

  void refine(const RowOf& row_of) {
    if (!begun) begin_refining(fit(stage, row_of));
    ReplayOptions options;
    options.method = study.refine.method;
    options.max_evaluations = static_cast<int>(study.refine.max_evaluations);
    options.tolerance_steps = study.refine.tolerance_steps;
    const auto lookup = [&](const Point& point) -> Known {
      const auto index = plan.index_of_id.find(design_id(design_of(box, point)));
      if (index == plan.index_of_id.end()) return {};
      const ResultRow* row = row_of(plan.designs[index->second]);
      if (row == nullptr) return {};
      if (row->state != "done") return {Known::State::hole, 0};
      return {Known::State::value, row->f_m};
    };
    bool going_on = false;
    for (std::size_t s = 0; s < starts.size(); ++s) {
      if (!ends[s].empty()) continue;
      const Replay walk = replay(box, options, starts[s], lookup);
      if (walk.asks) {
        const auto known = plan.index_of_id.find(design_id(design_of(box, *walk.asks)));
        if (known == plan.index_of_id.end()) add(*walk.asks);
        going_on = true;
      } else {
        ends[s] = fmt::format("start {} at {}: {}", s + 1, at_point(box, starts[s]), walk.why);
      }
    }
    if (going_on) return;
    // In the order of the starts, whichever came first.
    for (const std::string& end : ends) note(end);
    summary().complete = true;
  }

  /// The gate, and where to start.
  void begin_refining(const Fit& known) {
    begun = true;
    note(known.gate.reason);
    if (!known.surface) {
      note("no search: too few earlier results in the ranges");
      return;
    }
    const Point best = optimum(*known.surface, study.seed).at;
    if (!known.gate.smooth() && study.refine.only_if_smooth) {
      note(fmt::format("no optimiser on this surface; the optimum of the fit is simulated instead: {}",
                       at_point(box, best)));
      add(best);
      return;
    }
    // The fit's optimum, then simulated designs with low f, as far apart as they come: in order of f, each at least a
    // tenth of the box away from the starts before it.
    starts.push_back(best);
    std::vector<Sample> order = known.points;
    std::stable_sort(order.begin(), order.end(), [](const Sample& a, const Sample& b) { return a.f_m < b.f_m; });
    for (const Sample& sample : order) {
      if (starts.size() >= static_cast<std::size_t>(study.refine.starts)) break;
      const auto near = [&](const Point& start) {
        double squares = 0;
        for (std::size_t i = 0; i < box.size(); ++i)
          squares += std::pow((start[i] - sample.at[i]) / (box[i].high - box[i].low), 2);
        return squares < 0.01 * static_cast<double>(box.size());
      };
      if (std::none_of(starts.begin(), starts.end(), near)) starts.push_back(quantised(box, sample.at));
    }
    ends.resize(starts.size());
    note(fmt::format("{} from {} starts, at most {} designs each", study.refine.method, starts.size(),
                     study.refine.max_evaluations));
  }

  // --- replicate

  void replicate(const RowOf& row_of) {
    const Fit known = fit(stage, row_of);
    summary().complete = true;
    if (known.points.empty()) {
      note("nothing to replicate: no earlier design has a result");
      return;
    }
    std::vector<Point> chosen;
    const auto choose = [&](const Point& point) {
      if (chosen.size() < static_cast<std::size_t>(config().designs) &&
          std::find(chosen.begin(), chosen.end(), point) == chosen.end())
        chosen.push_back(point);
    };
    std::vector<Sample> order = known.points;
    if (known.surface) {
      choose(optimum(*known.surface, study.seed).at);
      note(fmt::format("the optimum of the fit, {}", at_point(box, chosen.front())));
      // The fit knows better than single noisy values which designs are good.
      for (Sample& sample : order) sample.f_m = known.surface->mean_m(sample.at);
    } else {
      note("the designs with the lowest f; " + known.gate.reason);
    }
    std::stable_sort(order.begin(), order.end(), [](const Sample& a, const Sample& b) { return a.f_m < b.f_m; });
    for (const Sample& sample : order) choose(sample.at);

    // Numbers that no design has used: what has been chosen for its luck is confirmed with fresh luck.
    double fresh = study.record.replicate + 1;
    for (const PlannedDesign& design : plan.designs) fresh = std::max(fresh, value_at(design, replicate_key, 0) + 1);
    for (const Point& point : chosen)
      for (std::int64_t r = 0; r < config().replicates; ++r) add(point, fresh + static_cast<double>(r), config().turns);
  }
};

Planner::Planner(const Study& study) : study_(study), plan_(plan_designs(study)) {
  for (std::size_t s = 0; s < study_.stages.size(); ++s)
    searches_.push_back(is_search(study_.stages[s]) ? std::make_unique<Search>(study_, plan_, s) : nullptr);
}

Planner::~Planner() = default;

bool Planner::complete() const {
  return std::all_of(plan_.stages.begin(), plan_.stages.end(), [](const StageSummary& s) { return s.complete; });
}

bool Planner::extend(const RowOf& row_of) {
  const auto ended = [&](const StageSummary& summary) {
    return std::all_of(summary.designs.begin(), summary.designs.end(),
                       [&](std::size_t i) { return row_of(plan_.designs[i]) != nullptr; });
  };
  for (std::size_t s = 0; s < plan_.stages.size(); ++s) {
    StageSummary& summary = plan_.stages[s];
    if (summary.complete) {
      if (!ended(summary)) return false;
      continue;
    }
    // A refinement goes on start by start, the others when all that they have asked for is there.
    Search& search = *searches_[s];
    const std::string& type = summary.type;
    if (type != "refine" && !ended(summary)) return false;
    const std::size_t before = summary.designs.size();
    if (type == "zoom") search.zoom(row_of);
    if (type == "adaptive") search.adaptive(row_of);
    if (type == "refine") search.refine(row_of);
    if (type == "replicate") search.replicate(row_of);
    return summary.complete || summary.designs.size() > before;
  }
  return false;
}

}  // namespace drumsweep
