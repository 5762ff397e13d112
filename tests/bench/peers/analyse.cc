/// Surface speed and charge angle of a LAMMPS or LIGGGHTS dump (columns x y vx vy ...), with drumsweep's own field and its definitions:
/// eight blocks of frames, as in core/scene/rotating_drum.cc. Usage: analyse DUMP; prints "v sigma angle sigma" in m/s and degrees.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/scene/slice_field.h"

namespace {

constexpr double radius = 0.375, diameter = 0.01, length = 0.1;
constexpr double ball = 4 * std::numbers::pi / 3 * 0.005 * 0.005 * 0.005;
constexpr std::size_t num_blocks = 8, frames_a_block = 16;  // as peers.sh dumps them

/// Mean and standard error, as drumsweep::estimate().
void print(const std::vector<double>& samples) {
  const auto n = static_cast<double>(samples.size());
  double mean = 0, squares = 0;
  for (const double s : samples) mean += s / n;
  for (const double s : samples) squares += (s - mean) * (s - mean);
  std::printf("%.4f %.4f ", mean, std::sqrt(squares / (n - 1) / n));
}

}  // namespace

int main(int num_arguments, char** arguments) {
  std::ifstream in(num_arguments == 2 ? arguments[1] : "");
  drumsweep::SliceField field(radius, diameter, length);
  std::vector<double> speeds, angles;
  std::size_t num_balls = 0, num_frames = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("ITEM: NUMBER")) in >> num_balls;
    if (!line.starts_with("ITEM: ATOMS")) continue;
    double x = 0, y = 0, vx = 0, vy = 0;
    for (std::size_t i = 0; i < num_balls && in >> x >> y >> vx >> vy; ++i) {
      if (num_frames > 0) field.add(x, y, vx, vy, ball);  // the first frame belongs to the settling
      in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    if (num_frames > 0) field.end_frame();
    if (num_frames > 0 && num_frames % frames_a_block == 0) {
      const double angle = field.surface_line().angle;
      const auto bins = field.profile(angle);
      speeds.push_back(drumsweep::SliceField::velocity_at(bins, drumsweep::SliceField::surface_position(bins)));
      angles.push_back(angle * 180 / std::numbers::pi);
      field.clear();
    }
    ++num_frames;
  }
  if (speeds.size() != num_blocks) {
    std::fprintf(stderr, "analyse: %zu frames, needs %zu\n", num_frames, num_blocks * frames_a_block + 1);
    return 1;
  }
  print(speeds);
  print(angles);
  std::puts("");
}
