/// Triangle meshes as files for CAD and ParaView, in metres, triangles counter-clockwise seen from the side that balls touch: normals
/// point to the balls. A wall is a surface without thickness, so none of these is watertight.
#pragma once

#include <string>

#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

/// Binary STL: 80 bytes of header, number, 50 bytes a triangle; little-endian.
std::string stl_file(const TriangleMesh& mesh, const std::string& name);

/// Wavefront OBJ with shared vertices.
std::string obj_file(const TriangleMesh& mesh, const std::string& name);

}  // namespace drumsweep
