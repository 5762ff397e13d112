/// A scene's result as a sealed HDF5 image: observables, series, final balls and walls, the scene file itself.
#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace drumsweep {

std::string pack_scene(SceneFile& file, const SceneResult& result);

/// What can be seen of a stored scene.
struct StoredScene {
  std::string name, type;
  double time_s = 0;
  Balls balls;
  std::vector<TriangleMesh> walls;  ///< in the room
};
/// @throws StoreError (damaged, foreign)
StoredScene unpack_scene(const std::string& bytes, const std::string& source);

}  // namespace drumsweep
