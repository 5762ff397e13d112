#include "postproc/export/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/io/hdf5_image.h"

namespace drumsweep {
namespace {

void append(std::vector<float>& list, const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) list.push_back(static_cast<float>(v[k]));
}

/// All frames behind one another, each filled up to `most` rows.
template <class T, class Part>
std::vector<T> padded(const Part& part, std::size_t num_frames, std::size_t most, std::size_t columns, T fill) {
  std::vector<T> all;
  all.reserve(num_frames * most * columns);
  for (std::size_t f = 0; f < num_frames; ++f) {
    const std::vector<T>& values = part(f);
    all.insert(all.end(), values.begin(), values.end());
    all.resize((f + 1) * most * columns, fill);
  }
  return all;
}

/// What XDMF has to know of an array.
struct Element {
  const char *name, *label, *type;
  int precision, columns;
};

std::vector<Element> elements_of(Trajectory::Kind kind) {
  std::vector<Element> list = {{"velocity", "velocity_m_s", "Float", 4, 3},
                               {"diameter", "diameter_m", "Float", 4, 1},
                               {"speed", "speed_m_s", "Float", 4, 1},
                               {"id", "id", "Int", 8, 1},
                               {"slot", "slot", "UChar", 1, 1}};
  if (kind == Trajectory::Kind::balls)
    list.push_back({"spin", "spin_rad_s", "Float", 4, 3});
  else
    list.push_back({"landed", "landed_s", "Float", 4, 1});
  return list;
}

/// The first `num` rows of frame `frame`.
std::string rows(const std::string& path, const Element& e, std::size_t frame, std::size_t num, std::size_t num_frames,
                 std::size_t most) {
  const bool flat = e.columns == 1;
  const auto shape = [&](std::size_t a, std::size_t b) {
    return flat ? fmt::format("{} {}", a, b) : fmt::format("{} {} {}", a, b, e.columns);
  };
  return fmt::format(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{}\" Type=\"HyperSlab\">\n"
      "          <DataItem Dimensions=\"3 {}\" Format=\"XML\">{} {} {}</DataItem>\n"
      "          <DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}</DataItem>\n"
      "        </DataItem>",
      flat ? fmt::format("{}", num) : fmt::format("{} {}", num, e.columns), flat ? 2 : 3,
      flat ? fmt::format("{} 0", frame) : fmt::format("{} 0 0", frame), flat ? "1 1" : "1 1 1", shape(1, num),
      shape(num_frames, most), e.type, e.precision, path);
}

std::string vertices_name(std::size_t frame) { return fmt::format("vertices/{:05d}", frame); }

std::string document(const std::string& name, const std::string& grids) {
  return fmt::format(
      "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n  <Domain>\n"
      "    <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}    </Grid>\n  "
      "</Domain>\n</Xdmf>\n",
      name, grids);
}

}  // namespace

void Trajectory::add(double time_s, const Balls& balls) { add(time_s, balls, {}); }

void Trajectory::add(double time_s, const Balls& balls, const std::vector<float>& landed_s) {
  Frame& frame = frames_.emplace_back();
  frame.time_s = time_s;
  frame.landed_s = landed_s;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    append(frame.position, balls.position[i]);
    append(frame.velocity, balls.velocity[i]);
    append(frame.spin, balls.spin[i]);
    frame.diameter.push_back(static_cast<float>(2 * balls.radius[i]));
    frame.speed.push_back(static_cast<float>(balls.velocity[i].norm()));
    frame.id.push_back(balls.id[i]);
    frame.slot.push_back(balls.exit[i]);
  }
}

std::size_t Trajectory::most_balls() const {
  std::size_t most = 0;
  for (const Frame& frame : frames_) most = std::max(most, frame.size());
  return most;
}

std::string Trajectory::h5() const {
  Hdf5Writer file;
  const std::vector<std::int64_t> version = {1, 1}, units = {1, 0};
  file.attribute("version", version, "h5md");
  file.attribute("name", std::string("not given"), "h5md/author");
  file.attribute("name", std::string("drumsweep"), "h5md/creator");
  file.attribute("version", std::string(DRUMSWEEP_VERSION), "h5md/creator");
  file.attribute("version", units, "h5md/modules/units");
  file.attribute("system", std::string("SI"), "h5md/modules/units");
  const std::string group = "particles/balls/";
  file.attribute("dimension", std::int64_t{3}, group + "box");
  file.attribute("boundary", std::vector<std::string>(3, "none"), group + "box");

  const std::size_t num = frames_.size(), most = most_balls();
  std::vector<std::int64_t> step;
  std::vector<double> time;
  for (std::size_t f = 0; f < num; ++f) {
    step.push_back(static_cast<std::int64_t>(f));
    time.push_back(frames_[f].time_s);
  }
  file.dataset(group + "position/step", step, 1, "1", "frame");
  file.dataset(group + "position/time", time, 1, "s", "simulated time");
  const auto element = [&](const std::string& name, auto member, std::size_t columns, auto fill, const char* unit,
                           const char* about) {
    using Values = std::remove_reference_t<decltype(frames_.front().*member)>;
    using T = typename std::remove_const_t<Values>::value_type;
    const auto part = [&](std::size_t f) -> const std::vector<T>& { return frames_[f].*member; };
    file.dataset(group + name + "/value", padded<T>(part, num, most, columns, static_cast<T>(fill)), columns, unit,
                 about, num);
    if (name == "position") return;
    for (const char* axis : {"/step", "/time"}) file.link(group + name + axis, group + "position" + axis);
  };
  element("position", &Frame::position, 3, 0, "m", "centre: along the belt, across it, up");
  element("velocity", &Frame::velocity, 3, 0, "m s-1", "of the centre");
  element("diameter", &Frame::diameter, 1, 0, "m", "");
  element("speed", &Frame::speed, 1, 0, "m s-1", "");
  element("id", &Frame::id, 1, -1, "1", "in the order of feeding; -1: no ball in this row");
  element("slot", &Frame::slot, 1, 0, "1", "way out: 0 inside, 1... slot, 254 never moves, 255 over the outlet's end");
  if (kind_ == Kind::balls)
    element("spin", &Frame::spin, 3, 0, "rad s-1", "angular velocity");
  else
    element("landed", &Frame::landed_s, 1, 0, "s", "simulated time of the landing");
  return file.plain();
}

std::string Trajectory::xmf(const std::string& h5_name) const {
  const std::size_t num_frames = frames_.size(), most = most_balls();
  const std::string root = h5_name + ":/particles/balls/";
  std::string grids;
  for (std::size_t f = 0; f < num_frames; ++f) {
    const std::size_t num = frames_[f].size();
    grids += fmt::format(
        "      <Grid Name=\"balls\">\n        <Time Value=\"{:.9g}\"/>\n"
        "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n"
        "        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
        frames_[f].time_s, num, rows(root + "position/value", {"", "", "Float", 4, 3}, f, num, num_frames, most));
    for (const Element& e : elements_of(kind_))
      grids += fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n",
                           e.label, e.columns == 3 ? "Vector" : "Scalar",
                           rows(root + e.name + "/value", e, f, num, num_frames, most));
    grids += "      </Grid>\n";
  }
  return document("balls", grids);
}

void WallTrajectory::add(double time_s, const TriangleMesh& mesh) {
  if (times_.empty())
    for (const auto& t : mesh.triangles)
      for (const std::int32_t corner : t) triangles_.push_back(static_cast<std::uint32_t>(corner));
  times_.push_back(time_s);
  std::vector<float>& vertices = vertices_.emplace_back();
  for (const Eigen::Vector3d& v : mesh.vertices) append(vertices, v);
  if (triangles_.size() != 3 * mesh.triangles.size() || vertices.size() != vertices_.front().size())
    throw std::logic_error(
        fmt::format("wall with {} triangles after one with {}", mesh.triangles.size(), triangles_.size() / 3));
}

std::string WallTrajectory::h5() const {
  Hdf5Writer file;
  file.dataset("triangles", triangles_, 3, "1", "rows of vertices, counter-clockwise seen from the balls' side");
  file.dataset("time", times_, 1, "s", "simulated time");
  // One array a frame: of a part of a larger one the reader complains, though it reads it.
  for (std::size_t f = 0; f < times_.size(); ++f) file.dataset(vertices_name(f), vertices_[f], 3, "m", "in the room");
  return file.plain();
}

std::string WallTrajectory::xmf(const std::string& h5_name) const {
  const std::size_t num = vertices_.front().size() / 3, num_triangles = triangles_.size() / 3;
  std::string grids;
  for (std::size_t f = 0; f < times_.size(); ++f)
    grids += fmt::format(
        "      <Grid Name=\"wall\">\n        <Time Value=\"{:.9g}\"/>\n"
        "        <Topology TopologyType=\"Triangle\" NumberOfElements=\"{}\">\n"
        "          <DataItem Dimensions=\"{} 3\" NumberType=\"UInt\" Precision=\"4\" Format=\"HDF\">{}:/triangles"
        "</DataItem>\n        </Topology>\n        <Geometry GeometryType=\"XYZ\">\n"
        "          <DataItem Dimensions=\"{} 3\" NumberType=\"Float\" Precision=\"4\" "
        "Format=\"HDF\">{}:/{}</DataItem>\n"
        "        </Geometry>\n      </Grid>\n",
        times_[f], num_triangles, num_triangles, h5_name, num, h5_name, vertices_name(f));
  return document("wall", grids);
}

Balls landed_balls(const std::vector<Landing>& landings, double time_s, double belt_speed, double height,
                   std::vector<float>& landed_s) {
  Balls balls;
  landed_s.clear();
  for (const Landing& l : landings) {
    if (l.time > time_s) continue;
    balls.add({l.x + belt_speed * (time_s - l.time), l.y, height + static_cast<double>(l.radius)},
              static_cast<double>(l.radius), l.ball_id);
    balls.velocity.back() =
        Eigen::Vector3d(static_cast<double>(l.vx), static_cast<double>(l.vy), static_cast<double>(l.vz));
    balls.exit.back() = l.exit;
    landed_s.push_back(static_cast<float>(l.time));
  }
  return balls;
}

}  // namespace drumsweep
