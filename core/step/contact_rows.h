/// Rows of the contact problem from where balls are and how they move: geometry and law of sixteen contacts at a time.
#pragma once

#include "core/contact/surface.h"
#include "core/solver/contact_problem.h"

namespace drumsweep {

/// The state at the beginning of a time step, as the rows read it.
struct RowInput {
  const double* position = nullptr;  ///< (balls x 3) [m]
  std::uint32_t num_balls = 0;
  const BodyVelocity* velocity = nullptr;  ///< (bodies)
  double time_step = 0;                    ///< [s]
  double margin = 0;  ///< gap up to which a pair has a row even if it does not close it in the step [m]
  double period = 0;  ///< along y; 0: not periodic [m]
  bool warm_start = true;
};

/// Fills normal, arm, overlap, bias, regularization and friction of all lanes, turns the impulses of the last step into the new tangent
/// planes, takes those of lanes without a row, and lists the packs that have a row or a pull.
/// @return whether some row is an impact with restitution
bool make_pair_rows(const RowInput& in, const Surface& surface, ContactPacks& pairs);

/// Likewise for contacts with a wall, whose normal, overlap and wall velocity are there already.
/// @param begin,end  packs of this wall
bool make_wall_rows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end,
                    ContactPacks& walls);

/// Puts those rows in order for the impact stage: -e u- where it collides, no approach where it touches, the gap elsewhere, all rigid.
void make_impact_rows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end, bool wall,
                      ContactPacks& packs);

}  // namespace drumsweep
