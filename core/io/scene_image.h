/// A scene's result as a sealed HDF5 image: observables, series, final balls, the scene file itself.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace drumsweep {

std::string pack_scene(SceneFile& file, const SceneResult& result);

}  // namespace drumsweep
