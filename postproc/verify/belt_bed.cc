#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/io/durable_file.h"
#include "core/scene/conveyor.h"
#include "postproc/bed.h"
#include "postproc/verify/groups.h"

namespace drumsweep {
namespace {

constexpr double friction_angle_deg = 35;  // S1, section 2

/// Profile of the automaton from the landings on [begin, begin + duration): mean height of each cell across [m].
std::vector<double> toppled_profile(const ConveyorScene& scene, const std::vector<Landing>& landings, double begin,
                                    double duration, double diameter) {
  BeltConfig belt;
  belt.width_m = scene.width_m;
  belt.speed_m_s = scene.belt_speed_m_s;
  belt.edge = scene.edge;
  ObjectiveConfig objective;
  objective.cell_diameters = scene.cell_m / diameter;
  objective.packing = scene.packing;
  Bed bed = build_bed(landings, begin, duration, belt, objective, bed_grid(belt, objective, diameter, duration, 1));
  topple(bed, friction_angle_deg);
  std::vector<double> out(static_cast<std::size_t>(bed.grid.num_across), 0.0);
  for (int i = 0; i < bed.grid.num_along; ++i)
    for (int j = 0; j < bed.grid.num_across; ++j)
      out[static_cast<std::size_t>(j)] += bed.height_m[bed.index(i, j)] / bed.grid.num_along;
  return out;
}

}  // namespace

// The band, one diameter, is ours: no bed is known better than to the size of its balls.
std::vector<VerifyCase> verify_belt_bed(const VerifyOptions& options) {
  std::vector<VerifyCase> out;
  ConveyorScene scene;
  scene.width_m = scene.band_end_m = 0.3;
  scene.length_m = 0.45;
  scene.measure_from_m = 0.2;
  scene.measure_s = options.full ? 20 : 2;
  Physics p;
  p.effects.rolling_friction = 0.3;
  p.solver.iterations = 10;
  // Even, a third on a heap, and all on a heap that must slide.
  for (const auto& [name, share, width] :
       {std::tuple{"even", 0.0, 0.02}, {"a third on a heap", 0.33, 0.02}, {"all on a heap", 1.0, 0.02}}) {
    scene.heap_share = share;
    scene.heap_width_m = width;
    scene.source_length_m = share == 1 ? 0.15 : 0.06;
    scene.exit_speed_m_s = share == 1 ? 1.0 : 0.5;
    const SceneResult r = scene.run(p, [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); });
    if (r.stopped) return out;
    const double expected =
        scene.feed_rate_kg_s / (p.material.density_kg_m3 * scene.packing * scene.width_m * scene.belt_speed_m_s);
    std::vector<double> height, sigma;
    double mean = 0, slope = 0;
    for (const Observable& o : r.observables) {
      if (o.name == "bed_height") {
        height.push_back(o.value);
        sigma.push_back(o.sigma);
      }
      if (o.name == "mean_height") mean = o.value;
      if (o.name == "max_slope") slope = o.value;
    }
    out.push_back(within(fmt::format("belt, {}: mean height of the bed [m]", name),
                         "rate/(density packing width speed)", expected, 0.01, mean));
    // What is measured at the place x landed x / belt speed earlier; for the middle of the section.
    const double middle = 0.5 * (scene.measure_from_m + scene.length_m) / scene.belt_speed_m_s;
    const std::vector<double> automaton =
        toppled_profile(scene, ConveyorScene::landings(r), r.simulated_s - scene.measure_s - middle, scene.measure_s,
                        p.material.diameter_m);
    double worst = 0;
    std::string data = "y_m,height_m,sigma_m,automaton_m\n";
    for (std::size_t j = 0; j < height.size() && j < automaton.size(); ++j) {
      worst = std::max(worst, std::abs(height[j] - automaton[j]));
      data += fmt::format("{},{},{},{}\n",
                          (static_cast<double>(j) + 0.5) * scene.width_m / static_cast<double>(height.size()),
                          height[j], sigma[j], automaton[j]);
    }
    std::string file = name;
    std::replace(file.begin(), file.end(), ' ', '_');
    write_durably(options.folder + "/belt_bed_" + file + ".csv", data);
    out.push_back(
        {fmt::format("belt, {}: largest difference of the automaton's profile [diameters]", name),
         "the bed ball by ball (scene conveyor)", "0, at most one diameter", 0, 1, worst / p.material.diameter_m,
         fmt::format(
             "highest cell {:.3g} mm, automaton {:.3g} mm; steepest slope {:.3g} deg, automaton at most {:g} deg",
             1e3 * *std::max_element(height.begin(), height.end()),
             1e3 * *std::max_element(automaton.begin(), automaton.end()), slope, friction_angle_deg)});
  }
  return out;
}

}  // namespace drumsweep
