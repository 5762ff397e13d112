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

}  // namespace

DesignChange change_of_design(const std::string& before, const std::string& after, std::int64_t seed) {
  const ResultTable tables[] = {with_means_of_replicates(read_results_csv(before + "/results.csv")),
                                with_means_of_replicates(read_results_csv(after + "/results.csv"))};
  if (tables[0].variable_names != tables[1].variable_names)
    throw InputError(fmt::format("{} varies {}, {} varies {}: accepted are sweeps over the same variables", before,
                                 fmt::join(tables[0].variable_names, ", "), after,
                                 fmt::join(tables[1].variable_names, ", ")));
  const std::vector<Measurement> rows[] = {done_rows(tables[0]), done_rows(tables[1])};
  DesignChange out;
  out.variables = tables[0].variable_names;
  const std::size_t num = out.variables.size();
  for (int i = 0; i < 2; ++i)
    if (rows[i].size() < num + 3)
      throw InputError(fmt::format("{}: {} designs are done: accepted is {} and more for a fit over {}",
                                   i == 0 ? before : after, rows[i].size(), num + 3, fmt::join(out.variables, ", ")));
  // What both have looked at.
  Box box;
  for (std::size_t k = 0; k < num; ++k) {
    DesignAxis axis{out.variables[k], -INFINITY, INFINITY, 0};
    for (const std::vector<Measurement>& list : rows) {
      const auto [low, high] = std::minmax_element(
          list.begin(), list.end(), [k](const Measurement& a, const Measurement& b) { return a.at[k] < b.at[k]; });
      axis.low = std::max(axis.low, low->at[k]);
      axis.high = std::min(axis.high, high->at[k]);
    }
    axis.resolution = (axis.high - axis.low) / 200;
    box.push_back(axis);
  }
  check_box(box);
  const auto fitted = [&](std::vector<Measurement> list) {
    std::erase_if(list, [&](const Measurement& m) {
      for (std::size_t k = 0; k < num; ++k)
        if (m.at[k] < box[k].low || m.at[k] > box[k].high) return true;
      return false;
    });
    return FittedSurface(box, list);
  };
  const FittedSurface plain = fitted(rows[0]), extended = fitted(rows[1]);
  out.before = optimum(plain, seed);
  out.after = optimum(extended, seed);
  out.regret_m = extended.mean_m(out.before.at) - extended.mean_m(out.after.at);
  // As if the two errors were independent; near each other they are not, and the regret is surer than that.
  out.regret_sigma_m = std::hypot(extended.sd_m(out.before.at), extended.sd_m(out.after.at));
  for (std::size_t k = 0; k < num; ++k) {
    const double half = 0.5 * std::hypot(out.before.high[k] - out.before.low[k], out.after.high[k] - out.after.low[k]);
    if (half > 0) out.spread = std::max(out.spread, std::abs(out.after.at[k] - out.before.at[k]) / half);
  }
  return out;
}

std::string describe(const DesignChange& c) {
  std::string out;
  const auto line = [&](const char* which, const Optimum& o) {
    std::vector<std::string> list;
    for (std::size_t k = 0; k < c.variables.size(); ++k)
      list.push_back(fmt::format("{} = {:.4g} [{:.4g}, {:.4g}]", c.variables[k], o.at[k], o.low[k], o.high[k]));
    out += fmt::format("  optimum {}: {}, f = {:.4g} +- {:.2g} m\n", which, fmt::join(list, ", "), o.f_m, o.sigma_m);
  };
  line("of the plain study   ", c.before);
  line("of the extended study", c.after);
  out += fmt::format(
      "  keeping the old design costs {:.3g} +- {:.2g} m of f; the optimum has moved by {:.1f} of the joint half width "
      "of "
      "the 95 % regions{}\n",
      c.regret_m, c.regret_sigma_m, c.spread, c.spread < 1 ? ", which is no change that these sweeps could tell" : "");
  return out;
}

}  // namespace drumsweep
