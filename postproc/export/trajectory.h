/// Balls over time for ParaView and other programs: HDF5 in the layout of H5MD 1.1, and XDMF 2 that says what is in it.
///
/// balls.h5: /particles/balls/NAME/value (frames x most balls x columns) with step and time; the number of balls varies, so rows
/// beyond a frame's number are 0 and their id is -1, as H5MD asks for. balls.xmf: a temporal collection of point sets, each the
/// rows that are there. Measured with ParaView 5.11 of Debian 12: reader "XDMF Reader" (of XDMF 2) opens it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/state/landing.h"
#include "postproc/still.h"

namespace drumsweep {

/// Balls and walls frame by frame, kept in single precision until they are written.
class Trajectory {
 public:
  /// Points that have no spin (landings) have none in the file.
  enum class Kind { balls, landings };
  explicit Trajectory(Kind kind = Kind::balls) : kind_(kind) {}

  void add(double time_s, const Balls& balls);
  /// Landings: their moment comes with each. @param landed_s  as many as balls
  void add(double time_s, const Balls& balls, const std::vector<float>& landed_s);
  std::size_t num_frames() const { return frames_.size(); }

  /// The two files. @param h5_name  of the first, in the same folder as the second
  std::string h5() const;
  std::string xmf(const std::string& h5_name) const;

 private:
  struct Frame {
    double time_s;
    std::vector<float> position, velocity, spin, diameter, speed, landed_s;
    std::vector<std::int64_t> id;
    std::vector<std::uint8_t> slot;
    std::size_t size() const { return id.size(); }
  };
  std::size_t most_balls() const;
  Kind kind_;
  std::vector<Frame> frames_;
};

/// A wall over time: triangles once, vertices in every frame.
class WallTrajectory {
 public:
  void add(double time_s, const TriangleMesh& mesh);
  std::size_t num_frames() const { return times_.size(); }
  std::string h5() const;
  std::string xmf(const std::string& h5_name) const;

 private:
  std::vector<double> times_;
  std::vector<std::vector<float>> vertices_;
  std::vector<std::uint32_t> triangles_;
};

/// Balls that have landed up to `time_s`, where the belt has carried them to: x + speed (time - landing), lying on the belt.
/// @param height  of the belt [m]  @param landed_s  out: moment of each [s]
Balls landed_balls(const std::vector<Landing>& landings, double time_s, double belt_speed, double height,
                   std::vector<float>& landed_s);

}  // namespace drumsweep
