/// Rendered picture of a drum: balls and walls, through POV-Ray.
#pragma once

#include <string>

#include "core/scene/drum.h"

namespace drumsweep {

struct PictureOptions {
  int width = 1400, height = 900;  ///< pixels
  std::string colour = "speed";    ///< or "axial": place along the axis; "slot": the way out
};

/// POV-Ray scene. Walls are drawn where they show their inside to the camera, which cuts the drum open on the near side; colours
/// run from dark (slow, uphill) to light (fast, downhill), so the picture reads in grey too.
std::string pov_scene(const DrumModel& model, const DrumState& state, const PictureOptions& options);

/// @param path  of the PNG. @throws std::runtime_error when POV-Ray is missing or fails
void write_picture(const DrumModel& model, const DrumState& state, const PictureOptions& options,
                   const std::string& path);

}  // namespace drumsweep
