/// Contacts of one ball with a triangle mesh: every local minimum of the distance to the mesh, each once.
///
/// A closest point in the inside of a face always counts. One on an edge or a vertex counts only if no triangle that
/// shares the edge or vertex has a nearer point: otherwise that neighbour already holds the contact. So a ball rolled
/// over an edge passes from face to edge to face and feels one contact throughout, at a distance that never jumps. Of
/// contacts with nearly the same direction only the deepest stays; where two swap they have equal gaps.
#pragma once

#include <span>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

struct WallContact {
  Eigen::Vector3d normal;  ///< from the wall to the ball's centre, unit length, in the frame of the mesh
  double distance;  ///< from the wall to the ball's centre; negative where a ball that must be in front is behind [m]
};

/// What is known of triangles that were looked at before: a centre that has travelled little cannot have reached one
/// that was far off.
struct WallSight {
  std::span<float> reached_after;  ///< (candidates, or empty) travelled before the centre can be at the triangle [m]
  double travelled = 0;            ///< by now, in the frame of the mesh [m]
};

inline constexpr int max_wall_contacts = 6;  ///< of one ball; deeper ones win

/// @param centre  of the ball, in the frame of the mesh [m]
/// @param candidates  triangles to look at, ascending; must hold every triangle within max_distance
/// @param in_front  the ball is on the front side of all walls: where its centre got behind a face it is pushed back
/// through it.
///   Otherwise walls push to whichever side the centre is on.
/// @param contacts  out: sorted by distance, all at most max_distance
/// @param sight  of earlier looks at the same candidates; brought up to date
void wall_contacts(const TriangleMesh& mesh, std::span<const std::int32_t> candidates, const Eigen::Vector3d& centre,
                   double max_distance, bool in_front, std::vector<WallContact>& contacts, const WallSight& sight = {});

}  // namespace drumsweep
