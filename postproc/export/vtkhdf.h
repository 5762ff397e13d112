/// VTKHDF 1.0, UnstructuredGrid: the part of that format which ParaView 5.11 reads. It has no time, so one moment a file; and its reader
/// is offered for the ending .hdf only.
/// Source: VTK 9.2, "VTK File Formats", section VTKHDF.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.h"
#include "core/state/drum_state.h"

namespace drumsweep {

/// Balls as vertices with velocity_m_s, spin_rad_s, diameter_m, speed_m_s, id, slot.
/// @param landed_s  of landings, their moments; else empty. Landings have no spin.
std::string vtkhdf_balls(const Balls& balls, const std::vector<float>& landed_s = {});

std::string vtkhdf_mesh(const TriangleMesh& mesh);

}  // namespace drumsweep
