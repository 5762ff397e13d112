#include "cli/estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/step/world.h"

namespace drumsweep {

CostEstimate estimate_cost(const Study& s) {
  CostEstimate e{};
  const double omega = s.drum.angular_velocity_rad_s;
  const World world(s, omega * s.drum.diameter_m / 2);
  e.ball_kg = world.mean_mass;
  e.balls_per_s = s.feed.rate_kg_s / e.ball_kg;
  // What is fed lies on the belt with the stated packing.
  e.bed_height_m =
      s.feed.rate_kg_s / (s.material.density_kg_m3 * s.objective.packing * s.belt.speed_m_s * s.belt.width_m);
  e.froude = omega * omega * s.drum.diameter_m / 2 / 9.81;
  e.turn_s = 2 * std::numbers::pi / omega;
  e.wall_speed_m_s = omega * s.drum.diameter_m / 2;
  e.step_s = world.time_step;

  // Sullivan, Maier, Ralston, US Bureau of Mines Technical Paper 384 (1927): minutes, with slope and angle of repose in
  // degrees and the speed in turns per minute; length and diameter in the same unit.
  const double rpm = 60 / e.turn_s;
  const double minutes = 1.77 * std::sqrt(s.objective.friction_angle_deg) * s.drum.length_m /
                         (s.drum.inclination_deg * s.drum.diameter_m * rpm);
  e.residence_s = 60 * minutes;
  e.balls = e.balls_per_s * e.residence_s;
  e.filling = e.balls * e.ball_kg / s.material.density_kg_m3 / s.objective.packing /
              (std::numbers::pi / 4 * s.drum.diameter_m * s.drum.diameter_m * s.drum.length_m);

  // Measured on the lab drum: 0.09 s of a core per 1000 balls and simulated second at 2500 solver passes a second.
  // "auto" is taken for 25 passes, a smooth step for 6.
  const double passes = s.step.method == "smooth" ? 6
                        : s.solver.iterations > 0 ? static_cast<double>(s.solver.iterations)
                                                  : 25;
  const double passes_per_s = passes / e.step_s;
  e.core_s_per_s = 0.09 * e.balls / 1000 * passes_per_s / 2500;
  e.memory_bytes = 1200 * e.balls;
  const double warmup_s = std::min(s.warmup.max_turns * e.turn_s, 3 * e.residence_s);
  e.warmup_core_s = 0.7 * warmup_s * e.core_s_per_s;  // it begins empty
  e.design_core_s = (s.record.adapt_turns + s.record.turns) * e.turn_s * e.core_s_per_s;
  return e;
}

}  // namespace drumsweep
