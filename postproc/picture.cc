#include "postproc/picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

constexpr int num_shades = 24;

/// Viridis (van der Walt and Smith 2015) at five places, linear between: lightness grows evenly.
Eigen::Vector3d shade(double t) {
  static const std::array<Eigen::Vector3d, 5> stops = {Eigen::Vector3d(0.267, 0.005, 0.329),
                                                       {0.229, 0.322, 0.546},
                                                       {0.128, 0.567, 0.551},
                                                       {0.369, 0.789, 0.383},
                                                       {0.993, 0.906, 0.144}};
  const double at = std::clamp(t, 0.0, 1.0) * 4;
  const auto i = std::min<std::size_t>(3, static_cast<std::size_t>(at));
  return stops[i] + (at - static_cast<double>(i)) * (stops[i + 1] - stops[i]);
}

std::string pov(const Eigen::Vector3d& v) { return fmt::format("<{:.5f},{:.5f},{:.5f}>", v[0], v[1], v[2]); }

/// 0 to 1 for the colour scale.
double measure(const DrumModel& model, const DrumState& state, std::size_t i, const std::string& colour) {
  if (colour == "slot") {
    const std::uint8_t exit = state.balls.exit[i];
    const double ways = static_cast<double>(model.wall.outlet.num_slots) + 1;
    return exit == static_cast<std::uint8_t>(Exit::end) ? 1.0 : exit / ways;
  }
  if (colour == "axial") {
    const double s = model.tilt.col(2).dot(state.balls.position[i] - model.pose(0).origin);
    return (s + model.study.drum.length_m) / (model.study.drum.length_m + model.study.outlet.length_m);
  }
  return state.balls.velocity[i].norm() / (1.5 * model.wall.outlet.radius * model.study.drum.angular_velocity_rad_s);
}

}  // namespace

std::string pov_scene(const DrumModel& model, const DrumState& state, const PictureOptions& options) {
  const Pose pose = model.pose(time_of(model, state.num_steps));
  const double r = model.wall.outlet.radius, length = model.study.drum.length_m + model.study.outlet.length_m;
  // From the side where the bed is low, beyond the outlet, a little above.
  const Eigen::Vector3d axis = model.tilt.col(2);
  const Eigen::Vector3d middle =
      pose.origin + axis * (model.study.outlet.length_m - 0.5 * length) - Eigen::Vector3d(0, 0, 0.3 * r);
  const double away = 1.55 * std::max(length, 3.2 * r);
  const Eigen::Vector3d camera = middle + away * Eigen::Vector3d(0.88, 0.62, 0.42);

  // POV-Ray is left-handed; with z up and "right" negated our right-handed axes appear as they are.
  std::string out = fmt::format(
      "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 }}\nbackground {{ rgb 1 }}\n"
      "camera {{ perspective location {} up z right -x*{:.4f} sky z look_at {} angle 46 }}\n"
      "light_source {{ {} rgb 0.95 area_light x*1, y*1, 3, 3 adaptive 1 }}\nlight_source {{ {} rgb 0.35 shadowless "
      "}}\n",
      pov(camera), static_cast<double>(options.width) / options.height, pov(middle),
      pov(camera + Eigen::Vector3d(0.5 * away, -0.6 * away, 1.2 * away)),
      pov(camera + Eigen::Vector3d(-0.5 * away, 0.5 * away, 0)));

  // Belt.
  const double half = 0.75 * r;
  out += fmt::format("box {{ {}, {} pigment {{ rgb <0.80,0.82,0.85> }} finish {{ ambient 0.25 diffuse 0.6 }} }}\n",
                     pov({-2 * half, 0, model.belt_height - 0.005}),
                     pov({2 * half, model.study.belt.width_m, model.belt_height}));

  // Wall: triangles that show their front.
  out += fmt::format("mesh2 {{ vertex_vectors {{ {}", model.mesh().vertices.size());
  std::vector<Eigen::Vector3d> placed;
  placed.reserve(model.mesh().vertices.size());
  for (const Eigen::Vector3d& v : model.mesh().vertices) {
    placed.push_back(pose.origin + pose.rotation * v);
    out += "," + pov(placed.back());
  }
  std::string faces;
  std::size_t num_faces = 0;
  for (const auto& t : model.mesh().triangles) {
    const Eigen::Vector3d &a = placed[static_cast<std::size_t>(t[0])], &b = placed[static_cast<std::size_t>(t[1])],
                          &c = placed[static_cast<std::size_t>(t[2])];
    if ((b - a).cross(c - a).dot(camera - a) <= 0) continue;
    faces += fmt::format(",<{},{},{}>", t[0], t[1], t[2]);
    ++num_faces;
  }
  out += fmt::format(
      "}} face_indices {{ {}{}}} pigment {{ rgb <0.62,0.60,0.58> }} finish {{ ambient 0.2 diffuse 0.65 }} }}\n",
      num_faces, faces);

  for (int i = 0; i < num_shades; ++i) {
    const Eigen::Vector3d c = shade((i + 0.5) / num_shades);
    // The stops are display colours; POV-Ray computes in linear light.
    out += fmt::format(
        "#declare T{} = texture {{ pigment {{ srgb <{:.3f},{:.3f},{:.3f}> }} finish {{ ambient 0.22 diffuse 0.75 "
        "specular 0.15 }} }}\n",
        i, c[0], c[1], c[2]);
  }
  for (std::size_t i = 0; i < state.balls.size(); ++i) {
    const int t =
        std::clamp(static_cast<int>(measure(model, state, i, options.colour) * num_shades), 0, num_shades - 1);
    out += fmt::format("sphere {{ {}, {:.5f} texture {{ T{} }} }}\n", pov(state.balls.position[i]),
                       state.balls.radius[i], t);
  }
  return out;
}

void write_picture(const DrumModel& model, const DrumState& state, const PictureOptions& options,
                   const std::string& path) {
  const ScratchFolder scratch;
  write_durably((scratch.path / "scene.pov").string(), pov_scene(model, state, options));
  run_program(scratch.path,
              {"povray", "+Iscene.pov", "+Opicture.png", fmt::format("+W{}", options.width),
               fmt::format("+H{}", options.height), "+A0.2", "-D", "-GA"},
              "install POV-Ray (Debian package povray)");
  write_durably(path, read_whole_file((scratch.path / "picture.png").string()));
}

}  // namespace drumsweep
