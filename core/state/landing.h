/// A ball that has reached the belt plane.
#pragma once

#include <cstdint>

namespace drumsweep {

/// How a ball left the drum.
enum class Exit : std::uint8_t {
  inside = 0,   ///< still in drum or outlet
  fixed = 254,  ///< glued to the ground of a scene: it never moves
  end = 255,    ///< over the open end of the outlet
  // 1 ... num_slots: through that slot
};

/// One landing. x runs with the belt, y across it from its edge (0 to belt width, outside when it fell past an edge).
struct Landing {
  double time = 0.0;             ///< simulation time at which the ball touched the belt plane [s]
  double x = 0.0, y = 0.0;       ///< place on the belt plane at that time, in the room (not moving with the belt) [m]
  float vx = 0, vy = 0, vz = 0;  ///< velocity [m/s]
  float radius = 0;              ///< [m]
  std::uint32_t ball_id = 0;
  std::uint8_t exit = 0;  ///< see Exit
};

}  // namespace drumsweep
