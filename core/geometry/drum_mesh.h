/// Wall of drum and outlet as one mesh in the body frame: z along the axis downhill, z = 0 where the outlet begins, the
/// drum at z in [-length, 0], its closed upper end a flat plate at -length, the outlet at z in [0, outlet length], open
/// at its end.
#pragma once

#include "core/config/study.h"
#include "core/geometry/outlet_shape.h"
#include "core/geometry/texture.h"
#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

/// What the mesh was made from.
struct DrumSurface {
  OutletShape outlet;
  Texture texture;
  double highest_bump = 0;  ///< of all vertices over the smooth cylinder, coating included [m]
};

struct DrumWall : DrumSurface {
  TriangleMesh mesh;  ///< front sides face the axis
};

/// Vertices lie exactly on the edges of the slots (no staircase); the drum's part does not depend on the outlet's slots
/// except for the last row of triangles, which joins the two.
DrumWall build_drum_wall(const Study& study, const OutletConfig& outlet);

}  // namespace drumsweep
