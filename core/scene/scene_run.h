/// What the scenes share: a run with its clock, quality and losses.
#pragma once

#include "core/scene/scene.h"
#include "core/step/step_report.h"

namespace drumsweep {

/// Steps a world and keeps the books. Build the world and the balls, then step() or run_until().
class SceneRun {
 public:
  /// @param box_low, box_high  a ball outside is lost: dropped and counted
  SceneRun(World world, const SceneObserver& observer, const Eigen::Vector3d& box_low, const Eigen::Vector3d& box_high);

  World world;
  BallState state;
  AfterMove after_move;  ///< may be empty
  int threads = 1;       ///< results do not depend on it

  double time() const { return time_of(world, state.num_steps); }
  /// One outer step. @return false when the observer stops the run
  bool step(const char* what, double planned_end_s);
  /// Steps until `time_s`, or until `done` (may be empty) says so after an outer step. @return as step()
  bool run_until(const char* what, double time_s, const std::function<bool()>& done = {});

  /// Adds a ball; its radius follows from its id (effects.size_spread).
  void add(const Eigen::Vector3d& at, const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero());
  /// Adds a ball that never moves.
  void add_fixed(const Eigen::Vector3d& at, double radius);
  /// Removes balls for which `gone` holds, without counting them as lost. @return how many
  std::size_t remove(const std::function<bool(std::size_t ball)>& gone);

  double kinetic_energy() const;  ///< of all moving balls, rotation included [J]
  double fastest() const;         ///< speed of the fastest moving ball [m/s]
  std::int64_t num_added() const { return num_added_; }
  const StepReport& last_report() const { return report_; }
  const Workspace& workspace() const { return work_; }

  /// Force that wall `w` exerts on the balls, mean over the sub-steps of the last outer step [N].
  Eigen::Vector3d wall_force(std::size_t w) const;

  /// The books, with the state moved out.
  SceneResult finish();

 private:
  SceneObserver observer_;
  Eigen::Vector3d low_, high_;
  Workspace work_;
  StepReport report_;
  ReportMean quality_;
  std::int64_t num_added_ = 0, lost_ = 0;
  std::uint32_t next_id_ = 0;
  double cpu_begin_ = 0;
  bool stopped_ = false;
};

/// Centres of a loose cubic lattice of cells 2.04 `radius` wide in a box, from the bottom up, each moved at random within the
/// slack; `keep` chooses. The order is by height, then y, then x.
std::vector<Eigen::Vector3d> lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                                     std::int64_t seed, const std::function<bool(const Eigen::Vector3d&)>& keep = {});

/// Sets an effect that this scene cannot show to an error. @throws InputError
void refuse_effects(const Physics& physics, const Where& where, const std::vector<std::string>& keys,
                    const std::string& scene);

}  // namespace drumsweep
