/// Balls in the layout of H5MD 1.1 with its units module, so that its readers (and h5py) find positions and velocities
/// without knowing this program. Source: H5MD 1.1.0 and module units 1.0.0, https://www.nongnu.org/h5md/
#pragma once

#include <cstdint>

#include "core/config/study.h"
#include "core/io/hdf5_image.h"
#include "core/state/drum_state.h"

namespace drumsweep {

/// Writes /h5md (metadata) and /particles/balls at one moment: position, velocity, spin, radius, mass, species (1: glued
/// to the ground of a scene), id and exit, each a group with value (1 x balls x columns), step and time, which all of
/// them share. The box has no boundary: walls are no part of H5MD.
void write_h5md(Hdf5Writer& file, const Balls& balls, const MaterialConfig& material, std::int64_t num_steps,
                double time_s);

/// The balls that write_h5md() wrote.
Balls read_h5md(const Hdf5Reader& file);

}  // namespace drumsweep
