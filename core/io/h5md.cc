#include "core/io/h5md.h"

#include <cmath>
#include <string>
#include <vector>

namespace drumsweep {
namespace {

std::vector<double> flat(const std::vector<Eigen::Vector3d>& vectors) {
  std::vector<double> out;
  out.reserve(3 * vectors.size());
  for (const Eigen::Vector3d& v : vectors) out.insert(out.end(), {v[0], v[1], v[2]});
  return out;
}

std::vector<Eigen::Vector3d> vectors(const std::vector<double>& values) {
  std::vector<Eigen::Vector3d> out(values.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return out;
}

}  // namespace

void write_h5md(Hdf5Writer& file, const Balls& balls, const MaterialConfig& material, std::int64_t num_steps,
                double time_s) {
  const std::vector<std::int64_t> version = {1, 1}, units = {1, 0};
  file.attribute("version", version, "h5md");
  file.attribute("name", std::string("not given"), "h5md/author");  // a person; a program cannot know
  file.attribute("name", std::string("drumsweep"), "h5md/creator");
  file.attribute("version", std::string(DRUMSWEEP_VERSION), "h5md/creator");
  file.attribute("version", units, "h5md/modules/units");
  file.attribute("system", std::string("SI"), "h5md/modules/units");

  // All elements are sampled at the same moment, so step and time are those of the positions.
  const std::string group = "particles/balls/";
  const std::vector<std::int64_t> step = {num_steps};
  const std::vector<double> time = {time_s};
  file.dataset(group + "position/step", step, 1, "1", "outer steps since the beginning");
  file.dataset(group + "position/time", time, 1, "s", "simulation time");
  const auto element = [&](const std::string& name, const auto& values, std::size_t columns, const char* unit,
                           const char* long_name) {
    file.dataset(group + name + "/value", values, columns, unit, long_name, 1);
    if (name == "position") return;
    for (const char* axis : {"/step", "/time"}) file.link(group + name + axis, group + "position" + axis);
  };
  std::vector<double> mass;
  std::vector<std::uint8_t> species;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    mass.push_back(4.0 / 3.0 * M_PI * std::pow(balls.radius[i], 3) * material.density_kg_m3);
    species.push_back(balls.exit[i] == static_cast<std::uint8_t>(Exit::fixed) ? 1 : 0);
  }
  element("position", flat(balls.position), 3, "m", "centre: along the belt, across it, up");
  element("velocity", flat(balls.velocity), 3, "m s-1", "of the centre");
  element("spin", flat(balls.spin), 3, "rad s-1", "angular velocity");
  element("radius", balls.radius, 1, "m", "radius");
  element("mass", mass, 1, "kg", "mass");
  element("species", species, 1, "1", "0: ball, 1: ball that never moves");
  element("id", balls.id, 1, "1", "in the order of feeding");
  element("exit", balls.exit, 1, "1", "0 inside, 1... slot, 254 never moves, 255 over the outlet's end");
  const std::vector<std::string> boundary(3, "none");
  file.attribute("dimension", std::int64_t{3}, group + "box");
  file.attribute("boundary", boundary, group + "box");
}

Balls read_h5md(const Hdf5Reader& file) {
  Balls balls;
  balls.position = vectors(file.doubles("particles/balls/position/value"));
  balls.velocity = vectors(file.doubles("particles/balls/velocity/value"));
  balls.spin = vectors(file.doubles("particles/balls/spin/value"));
  balls.radius = file.doubles("particles/balls/radius/value");
  balls.id = file.uint32s("particles/balls/id/value");
  balls.exit = file.uint8s("particles/balls/exit/value");
  return balls;
}

}  // namespace drumsweep
