#include "diagnosis/report/design_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/config/schema.h"
#include "postproc/result_table.h"

namespace drumsweep {
namespace {

std::vector<Measurement> done_rows(const ResultTable& table) {
  std::vector<Measurement> rows;
  for (const ResultRow& r : table.rows)
    if (r.state == "done" && std::isfinite(r.f_m)) rows.push_back({r.variables, 0, r.f_m, r.sigma_f_m});
  return rows;
}

/// What all sweeps have looked at.
Box common_box(const std::vector<std::string>& variables, const std::vector<std::vector<Measurement>>& sweeps) {
  Box box;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    DesignAxis axis{variables[k], -INFINITY, INFINITY, 0};
    for (const std::vector<Measurement>& rows : sweeps) {
      const auto [low, high] = std::minmax_element(
          rows.begin(), rows.end(), [k](const Measurement& a, const Measurement& b) { return a.at[k] < b.at[k]; });
      axis.low = std::max(axis.low, low->at[k]);
      axis.high = std::min(axis.high, high->at[k]);
    }
    axis.resolution = (axis.high - axis.low) / 200;
    box.push_back(axis);
  }
  check_box(box);
  return box;
}

FittedSurface fitted(const Box& box, std::vector<Measurement> rows) {
  std::erase_if(rows, [&](const Measurement& m) {
    for (std::size_t k = 0; k < box.size(); ++k)
      if (m.at[k] < box[k].low || m.at[k] > box[k].high) return true;
    return false;
  });
  return FittedSurface(box, rows);
}

/// Most that two optima differ in one variable, over the joint half width of their 95 % regions.
double distance(const Optimum& a, const Optimum& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.at.size(); ++k) {
    const double half = 0.5 * std::hypot(a.high[k] - a.low[k], b.high[k] - b.low[k]);
    if (half > 0) most = std::max(most, std::abs(a.at[k] - b.at[k]) / half);
  }
  return most;
}

/// As if the two errors were independent; near each other they are not, and the regret is surer than that.
Regret regret_of(const FittedSurface& truth, const Point& built, const Point& best) {
  if (built == best) return {};
  return {truth.mean_m(built) - truth.mean_m(best), std::hypot(truth.sd_m(built), truth.sd_m(best))};
}

}  // namespace

bool DesignChange::agree() const {
  return std::all_of(regret.at(safest).begin(), regret.at(safest).end(),
                     [](const Regret& r) { return r.f_m <= 2 * r.sigma_m; });
}

DesignChange change_of_design(const std::string& before, const std::vector<std::string>& after, std::int64_t seed) {
  std::vector<std::string> folders = {before};
  folders.insert(folders.end(), after.begin(), after.end());
  DesignChange out;
  std::vector<std::vector<Measurement>> sweeps;
  for (const std::string& folder : folders) {
    const ResultTable table = with_means_of_replicates(read_results_csv(folder + "/results.csv"));
    if (sweeps.empty()) out.variables = table.variable_names;
    if (table.variable_names != out.variables)
      throw InputError(fmt::format("{} varies {}, {} varies {}: accepted are sweeps over the same variables", before,
                                   fmt::join(out.variables, ", "), folder, fmt::join(table.variable_names, ", ")));
    sweeps.push_back(done_rows(table));
    if (sweeps.back().size() < out.variables.size() + 3)
      throw InputError(fmt::format("{}: {} designs are done: accepted is {} and more for a fit over {}", folder,
                                   sweeps.back().size(), out.variables.size() + 3, fmt::join(out.variables, ", ")));
  }
  const Box box = common_box(out.variables, sweeps);
  out.before = optimum(fitted(box, sweeps[0]), seed);
  std::vector<FittedSurface> surfaces;
  for (std::size_t i = 1; i < sweeps.size(); ++i) {
    surfaces.push_back(fitted(box, sweeps[i]));
    DesignChange::Member member;
    member.after = optimum(surfaces.back(), seed);
    member.of_old = regret_of(surfaces.back(), out.before.at, member.after.at);
    member.spread = distance(out.before, member.after);
    out.members.push_back(std::move(member));
  }
  double least = INFINITY;
  for (std::size_t i = 0; i < out.members.size(); ++i) {
    out.regret.emplace_back();
    double most = 0;
    for (std::size_t j = 0; j < out.members.size(); ++j) {
      out.regret[i].push_back(regret_of(surfaces[j], out.members[i].after.at, out.members[j].after.at));
      most = std::max(most, out.regret[i][j].f_m);
      out.apart = std::max(out.apart, distance(out.members[i].after, out.members[j].after));
    }
    if (most < least) {
      least = most;
      out.safest = i;
    }
  }
  return out;
}

}  // namespace drumsweep
