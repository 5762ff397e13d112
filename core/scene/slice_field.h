/// Fields of a granular flow in a plane across a drum's axis, collected over time: solid fraction and mean velocity, and from them the
/// free surface and the velocity profile. Definitions: rotating_drum.h.
#pragma once

#include <cstddef>
#include <vector>

namespace drumsweep {

class SliceField {
 public:
  /// @param radius  of the drum [m]; @param length  along the axis, of what is added [m]
  SliceField(double radius, double diameter, double length);

  /// A ball at (x, z) from the axis. Balls outside the square around the drum are left out.
  void add(double x, double z, double vx, double vz, double volume);
  void end_frame() { ++frames_; }
  void clear();

  struct Bin {
    double y;         ///< from the axis along the normal [m]
    double fraction;  ///< solid
    double u;         ///< down-slope velocity, NaN without a ball [m/s]
  };
  /// Along the normal of a surface that falls by `angle` towards +x, by ascending y.
  std::vector<Bin> profile(double angle) const;

  double mass_centre_angle() const;  ///< [rad]

  struct Point {
    double x, z;
  };
  /// Highest point of the bed in each column, by ascending x.
  std::vector<Point> surface() const;

  struct Line {
    double angle = 0;        ///< [rad]
    double distance = 0;     ///< y where the normal meets it, negative below the axis [m]
    std::size_t points = 0;  ///< columns in the fit; below 3 there is none
  };
  Line surface_line() const;

  /// y at which the bins' solid fraction, averaged over a diameter, falls below the surface's; NaN where none does.
  static double surface_position(const std::vector<Bin>& bins);
  /// u at y, linear between bins.
  static double velocity_at(const std::vector<Bin>& bins, double y);
  /// Highest y below the surface at which u changes sign; NaN where none does.
  static double zero_position(const std::vector<Bin>& bins);

 private:
  double radius_, diameter_, length_, cell_;
  std::size_t num_;  ///< cells a side
  std::size_t frames_ = 0;
  std::vector<double> volume_, flux_x_, flux_z_;  ///< (num x num), x fastest; flux: volume times velocity
};

}  // namespace drumsweep
