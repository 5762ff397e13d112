// How many simulations find the optimum? Strategies against each other on a surface that is known:
// `build/release/tests/strategies RESULTS.csv f_m|f_footprint_m [SEEDS]`, RESULTS.csv of a grid with replicates (columns of the two
// variables between `state` and `replicate`).
//
// Truth: the fit of all rows. A simulated run is truth + a smooth error shared by its replicate + its own error, both of the size,
// share and length that the fit found in the rows; its stated sigma is a jackknife's over six blocks. Distances are in the variables'
// units and of the box; regret is F(found) - F(best).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/geometry/random.h"
#include "postproc/result_table.h"
#include "sweep/fit/acquisition.h"
#include "sweep/fit/gate.h"
#include "sweep/fit/optimum.h"
#include "sweep/refine/nlopt_replay.h"
#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

struct Grid {
  Box box;
  std::vector<Measurement> rows;
};

Grid read_grid(const std::filesystem::path& path, const std::string& column) {
  const ResultTable table = read_results_csv(path);
  Grid out;
  const std::size_t num = table.variable_names.size() - 1;  // the last is the replicate
  for (std::size_t k = 0; k < num; ++k) out.box.push_back({table.variable_names[k], 1e99, -1e99, 1});
  for (const ResultRow& row : table.rows) {
    if (row.state != "done") continue;
    const bool footprint = column == "f_footprint_m";
    out.rows.push_back({{row.variables.begin(), row.variables.begin() + static_cast<std::ptrdiff_t>(num)},
                        row.variables.back(),
                        footprint ? row.f_footprint_m : row.f_m,
                        footprint ? row.sigma_f_footprint_m : row.sigma_f_m});
    for (std::size_t k = 0; k < num; ++k) {
      out.box[k].low = std::min(out.box[k].low, row.variables[k]);
      out.box[k].high = std::max(out.box[k].high, row.variables[k]);
    }
  }
  for (DesignAxis& axis : out.box) axis.resolution = (axis.high - axis.low) / 90;
  return out;
}

/// The truth with noise as measured.
struct World {
  const FittedSurface& truth;
  std::map<Point, double> values = {};  // of the truth, as asking costs

  double value(const Point& at) {
    const auto [found, is_new] = values.try_emplace(at, 0);
    if (is_new) found->second = truth.mean_m(at);
    return found->second;
  }
  Measurement measure(const Point& at, double replicate, std::int64_t seed) {
    const SurfaceParameters& p = truth.parameters();
    Laboratory noise;
    noise.box = truth.box();
    noise.seed = seed;
    Point unit = to_unit(truth.box(), at);
    const double own = truth.noise_trend().sigma(truth.box(), at);
    // The laboratory's waves have length 0.6.
    for (double& u : unit) u *= 0.6 / p.shared_length;
    const double smooth = noise.smooth_error(unit, replicate);
    noise.shared = 0;
    noise.sigma_m = 1;
    noise.truth = [](const Point&) { return 0.0; };
    const Measurement white = noise.measure(at, replicate);
    const double scale = 0.6 + 0.8 * to_unit(truth.box(), at).back();
    return {at, replicate,
            value(at) + p.rho * own * (std::sqrt(p.shared) * smooth + std::sqrt(1 - p.shared) * white.f_m / scale),
            own * white.sigma_m / scale};
  }
};

struct Found {
  int num_runs = 0;
  Point at;
  double width = 0;   // of the 95 % region, mean over the variables, of the box; 0 without
  double inside = 0;  // share of the variables whose best value lies in the region
};

using Trace = std::vector<Found>;

Found from_fit(const FittedSurface& fit, int num_runs, std::int64_t seed, const Point& best) {
  const Optimum o = optimum(fit, seed, {250, 250, 8});
  Found out{num_runs, o.at, 0, 0};
  for (std::size_t k = 0; k < best.size(); ++k) {
    const DesignAxis& axis = fit.box()[k];
    out.width += (o.high[k] - o.low[k]) / (axis.high - axis.low) / static_cast<double>(best.size());
    const double step = axis.resolution / 2;  // the region is not on the lattice, the best point is
    out.inside += (o.low[k] - step <= best[k] && best[k] <= o.high[k] + step) / static_cast<double>(best.size());
  }
  return out;
}

Trace grid_and_lowest_row(World& world, std::int64_t seed, const Point& best, bool fitted) {
  Trace out;
  for (const int side : {3, 4, 5, 6, 7, 9, 10}) {
    std::vector<Measurement> rows;
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j)
        rows.push_back(world.measure(
            quantised(world.truth.box(), from_unit(world.truth.box(), {i / (side - 1.0), j / (side - 1.0)})), 0, seed));
    const auto lowest =
        std::min_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.f_m < b.f_m; });
    const int num = side * side;
    out.push_back(fitted ? from_fit(FittedSurface(world.truth.box(), rows), num, seed, best) : Found{num, lowest->at});
  }
  return out;
}

/// Four starts on replicate 0 side by side, a round one run of each.
Trace nlopt(World& world, std::int64_t seed, const std::string& method) {
  const Box& box = world.truth.box();
  const std::vector<Point> starts = space_filling(box, 4, seed);
  std::map<Point, double> known;
  Trace out;
  for (bool busy = true; busy && known.size() < 110;) {
    busy = false;
    std::vector<Point> asked;
    for (const Point& start : starts) {
      const Replay r = replay(box, {method, 30, 1, 0.2}, start, [&](const Point& at) {
        const auto found = known.find(at);
        return found == known.end() ? Known{} : Known{Known::State::value, found->second};
      });
      if (r.asks) asked.push_back(*r.asks);
    }
    for (const Point& at : asked) known[at] = world.measure(at, 0, seed).f_m;
    busy = !asked.empty();
    const auto lowest =
        std::min_element(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    out.push_back({static_cast<int>(known.size()), lowest->first});
  }
  return out;
}

/// @param spread  the first points run under numbers of their own, else all under replicate 0
Trace adaptive(World& world, std::int64_t seed, const Point& best, int first, bool spread, int batch, int most) {
  const Box& box = world.truth.box();
  std::vector<Measurement> rows;
  for (const Point& at : space_filling(box, static_cast<std::size_t>(first), seed))
    rows.push_back(world.measure(at, spread ? static_cast<double>(rows.size()) : 0, seed));
  Trace out;
  for (;;) {
    const FittedSurface fit(box, rows);
    out.push_back(from_fit(fit, static_cast<int>(rows.size()), seed, best));
    if (static_cast<int>(rows.size()) + batch > most) return out;
    for (const Proposal& run : next_batch(fit, batch, seed).runs)
      rows.push_back(world.measure(run.at, run.replicate, seed));
  }
}

/// Means over the seeds: what each strategy had found by a number of runs.
void print(const std::string& name, World& world, const std::vector<Trace>& traces, const Point& best, double lowest) {
  for (const int num : {9, 16, 25, 36, 49, 64, 81, 100}) {
    double regret = 0, worst = 0, distance = 0, width = 0, inside = 0, miss[2] = {0, 0}, runs = 0;
    int count = 0;
    for (const Trace& trace : traces) {
      const Found* last = nullptr;
      for (const Found& found : trace)
        if (found.num_runs <= num) last = &found;
      if (!last) continue;
      ++count;
      runs += last->num_runs;
      const double r = world.value(last->at) - lowest;
      regret += r;
      worst = std::max(worst, r);
      double square = 0;
      for (std::size_t k = 0; k < best.size(); ++k) {
        const DesignAxis& axis = world.truth.box()[k];
        const double off = std::abs(last->at[k] - best[k]);
        square += std::pow(off / (axis.high - axis.low), 2);
        if (k < 2) miss[k] += off;
      }
      distance += std::sqrt(square);
      width += last->width;
      inside += last->inside;
    }
    if (count < static_cast<int>(traces.size())) continue;
    const double n = count;
    fmt::print("{:<22} {:>5} {:>6.1f} {:>9.3f} {:>9.2f} {:>9.4f} {:>11.1e} {:>10.1e} {:>7.2f} {:>7.2f}\n", name, num,
               runs / n, distance / n, miss[0] / n, miss[1] / n, regret / n, worst, width / n, inside / n);
  }
  std::fflush(stdout);
}

int run(const std::filesystem::path& path, const std::string& column, int num_seeds) {
  const Grid grid = read_grid(path, column);
  const FittedSurface truth(grid.box, grid.rows);
  World world{truth};
  const Pooled pooled = pool(grid.box, grid.rows);
  const SurfaceParameters& p = truth.parameters();
  fmt::print(
      "{} rows at {} points; scatter of replicates over own sigma {:.2f} ({} degrees of freedom); var(f_i - f_j) "
      "between replicates over within {:.2f}, neighbours {:.1f}\n",
      grid.rows.size(), pooled.samples.size(), pooled.noise.scatter_over_own, pooled.noise.scatter_dof,
      pooled.noise.gain, pooled.noise.gain_neighbours);
  fmt::print("fit: lengths {:.2f} {:.2f}, amplitude {:.4f} m, rho {:.2f}, shared {:.3f}, its length {:.2f}\n",
             p.length[0], p.length[1], p.amplitude_m, p.rho, p.shared, p.shared_length);
  const Optimum o = optimum(truth, 1);
  fmt::print("optimum of all rows: {} = {} ({:.3g} to {:.3g}), {} = {} ({:.3g} to {:.3g}), f = {:.5f} +- {:.5f} m\n",
             grid.box[0].key, o.at[0], o.low[0], o.high[0], grid.box[1].key, o.at[1], o.low[1], o.high[1], o.f_m,
             o.sigma_m);
  fmt::print("gate: {}\n\n", gate(truth).reason);

  // The truth's own optimum, on the lattice.
  Point best;
  double lowest = 1e99;
  for (const Point& at : whole_lattice(grid.box))
    if (const double f = world.value(at); f < lowest) {
      lowest = f;
      best = at;
    }

  fmt::print("{:<22} {:>5} {:>6} {:>9} {:>9} {:>9} {:>11} {:>10} {:>7} {:>7}\n", "strategy", "up to", "runs",
             "distance", grid.box[0].key.substr(0, 9), grid.box[1].key.substr(0, 9), "regret [m]", "worst [m]", "width",
             "inside");
  std::map<std::string, std::vector<Trace>> traces;
  for (std::int64_t seed = 1; seed <= num_seeds; ++seed) {
    traces["1 grid, lowest row"].push_back(grid_and_lowest_row(world, seed, best, false));
    traces["2 grid, fit"].push_back(grid_and_lowest_row(world, seed, best, true));
    traces["3 nlopt bobyqa x 4"].push_back(nlopt(world, seed, "bobyqa"));
    traces["4 nlopt sbplx x 4"].push_back(nlopt(world, seed, "sbplx"));
    traces["5 adaptive 0, by 4"].push_back(adaptive(world, seed, best, 12, false, 4, 64));
    traces["6 adaptive, by 4"].push_back(adaptive(world, seed, best, 12, true, 4, 64));
    traces["7 adaptive, by 8"].push_back(adaptive(world, seed, best, 12, true, 8, 64));
  }
  for (const auto& [name, of_seeds] : traces) print(name, world, of_seeds, best, lowest);
  return 0;
}

}  // namespace
}  // namespace drumsweep

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: strategies RESULTS.csv f_m|f_footprint_m [SEEDS]\n");
    return 2;
  }
  return drumsweep::run(argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 10);
}
