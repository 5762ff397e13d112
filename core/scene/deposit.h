/// What the scenes with many balls share: pouring, coming to rest, and the shape and structure of what lies there then.
///
/// Surfaces are heights seen from above: over each point of a grid the highest point of any ball. Such a surface lies below the
/// highest tops by part of a diameter, alike everywhere, so slopes and differences of heights do not depend on it.
#pragma once

#include <functional>
#include <vector>

#include "core/scene/scene_run.h"

namespace drumsweep {

/// Lets balls go one by one at a mass flow, each where no other ball is.
class Source {
 public:
  /// @param place  a point from three numbers uniform in [0, 1)
  using Place = std::function<Eigen::Vector3d(double, double, double)>;

  /// Adds what is due: balls while the debt holds one and a free place is found.
  /// @param debt_kg  mass that is due; less what was added afterwards
  void pour(SceneRun& run, double& debt_kg, const Place& place, const Eigen::Vector3d& velocity);

 private:
  std::uint64_t draws_ = 0;
};

/// Lattice of cells 1.25 diameters wide, each ball moved at random by up to a tenth of a diameter: loose and disordered enough to
/// settle without crystal order.
std::vector<Eigen::Vector3d> loose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                                           std::int64_t seed,
                                           const std::function<bool(const Eigen::Vector3d&)>& keep = {});

/// Height that `num` balls of loose_lattice() need between the sides `low` and `high` [m].
double loose_height(std::size_t num, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                    const std::function<bool(const Eigen::Vector3d&)>& keep = {});

/// Glues a layer of mean balls to the ground, tops at z <= 0: a triangular lattice one diameter wide, each ball moved at random by up
/// to 0.15 d along the ground and 0.3 d down, where `keep(x, y)` holds. Nothing falls through.
void glue_base(SceneRun& run, double x_low, double x_high, double y_low, double y_high,
               const std::function<bool(double x, double y)>& keep);

/// Whether a ball is one that moves.
bool is_free(const Balls& balls, std::size_t i);

/// Pressed contacts of each ball in the last step, with balls and walls. (balls)
std::vector<int> contacts_of_balls(const BallState& state);

/// Kinetic energy of translation per free ball over m g d. Rotation is left out: without twisting resistance nothing stops a ball that
/// spins about its only contact's normal, in the model as on a slippery tip, and that does not move the heap.
double kinetic_energy_per_ball(const SceneRun& run);

inline constexpr double at_rest = 1e-6;  ///< kinetic_energy_per_ball(): speeds of about 1e-3 sqrt(g d)

/// Runs until all but at_rest of the motion is gone for 0.1 s, or for `longest_s`; then for another 0.2 s to see whether it creeps.
struct Rest {
  double kinetic_energy = 0;  ///< kinetic_energy_per_ball() at the end
  double creep = 0;           ///< mean speed of the balls from their displacement over the last 0.2 s [m/s]
  bool reached = false;
  double time = 0;  ///< when the motion had gone [s]
};
Rest come_to_rest(SceneRun& run, double longest_s, const std::function<void()>& after_step = {});

/// Observables "residual_kinetic_energy", "creep" and "at_rest" of it.
void add_rest(const Rest& rest, std::vector<Observable>& out);

/// Heights of the visible surface on a grid of squares; `floor` where no ball is.
struct HeightMap {
  double x_low = 0, y_low = 0, cell = 0;
  int nx = 0, ny = 0;
  std::vector<double> height;  ///< (ny x nx) [m]

  double x(int i) const { return x_low + (i + 0.5) * cell; }
  double y(int j) const { return y_low + (j + 0.5) * cell; }
  double at(int i, int j) const {
    return height[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)];
  }
};
/// @param period  along y; 0: not periodic
/// @param counts  which balls are looked at
HeightMap surface_from_above(const Balls& balls, double x_low, double x_high, double y_low, double y_high, double cell,
                             double floor, double period, const std::function<bool(std::size_t)>& counts);

/// Volume of balls over volume, of the points of a fine grid in a box at which `within` holds, with a standard error from the parts
/// that `part(point)` sorts them into (0 .. num_parts - 1).
Estimate packing_fraction(const Balls& balls, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double period,
                          const std::function<bool(const Eigen::Vector3d&)>& within,
                          const std::function<std::size_t(const Eigen::Vector3d&)>& part, std::size_t num_parts);

/// Mean number of pressed contacts of the free balls for which `counts` holds; the standard error takes balls as independent.
Estimate coordination_number(const BallState& state, const std::function<bool(std::size_t)>& counts);

/// Free balls that a chain of gaps below `gap` joins to a ball for which `seed` holds. (balls)
std::vector<char> connected(const Balls& balls, double period, double gap,
                            const std::function<bool(std::size_t)>& seed);

/// Straight line y = offset + slope x by least squares.
struct Line {
  double offset = 0, slope = 0;
  std::size_t points = 0;
};
Line fit_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace drumsweep
