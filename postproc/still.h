/// Balls and walls at one moment, in the room: what pictures and exports show of a drum or of a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/scene_image.h"
#include "core/scene/discharge.h"

namespace drumsweep {

struct Still {
  struct Wall {
    std::string name;   ///< "drum", "belt", "wall", "wall1" ...: also of files
    TriangleMesh mesh;  ///< [m]
  };
  /// Of a drum: its axis in the room, from the upper end to the outlet's end.
  struct Drum {
    Eigen::Vector3d begin, outlet, end;  ///< points on the axis [m]
    double radius = 0;                   ///< [m]
    int num_slots = 0;
  };

  std::string name;   ///< of the study or scene
  double time_s = 0;  ///< simulated
  Balls balls;
  std::vector<Wall> walls;
  std::optional<Drum> drum;
};

/// A drum with a bare belt, which has no balls where the state is one of a sweep.
Still still_of(const DrumModel& model, const DrumState& state, double belt_height);
Still still_of(const Discharge& discharge);
Still still_of(StoredScene scene);

}  // namespace drumsweep
