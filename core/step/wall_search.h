/// Which triangles a ball may touch before the next contact search.
#pragma once

#include <span>

#include "core/contact/pair_search.h"
#include "core/contact/wall_contact.h"
#include "core/state/drum_state.h"
#include "core/step/world.h"

namespace drumsweep {

/// Triangles that one ball may touch before the next contact search.
struct NearWall {
  std::uint32_t ball, wall;
  std::uint32_t begin, end;  ///< range in WallCandidates::triangles
  double travelled = -1;  ///< in the wall's frame since it was first looked at, up to `last`; -1: never looked at [m]
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
};
struct WallCandidates {
  std::vector<NearWall> balls;  ///< by wall, then by ball
  std::vector<std::int32_t> triangles;
  std::vector<float> reached_after;  ///< (triangles), or empty where each step searches anew: see WallSight
};

/// Lists, for every ball of a slab near a wall, the triangles within its reach: contact distance, margin, and what it can
/// travel relative to the wall in one outer step.
/// @param inverse_mass  (balls) 0 for balls that never move
void find_wall_candidates(const World& world, const Balls& balls, const PairList& list, std::size_t slab,
                          std::span<const double> inverse_mass, std::span<const Pose> poses,
                          WallCandidates& candidates);

/// Contacts of one ball with its candidates, as the step sees them. A triangle is not
/// looked at while the ball has travelled too little to be near it.
void contacts_of(const World& world, const Balls& balls, NearWall& near, WallCandidates& candidates, const Pose& pose,
                 double max_distance, std::vector<WallContact>& contacts);

/// Finds what contacts of one ball with one wall were in the last time step, by the nearest direction, each once.
class WallMemory {
 public:
  /// @param old  by wall, then by ball
  explicit WallMemory(std::span<const WallImpulse> old) : old_(old) {}
  /// Goes on to this ball and wall; calls must ascend as `old` does.
  void turn_to(std::uint32_t wall, std::uint32_t ball);
  /// @param direction  in the wall's frame
  /// @return index in `old`, or -1
  std::ptrdiff_t take(const Eigen::Vector3f& direction);

 private:
  std::span<const WallImpulse> old_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint32_t taken_ = 0;
};

/// By wall, then by ball; those of one ball stay in their order.
void sort_wall_impulses(std::vector<WallImpulse>& walls, std::vector<Turn>& turns);

}  // namespace drumsweep
