#include "postproc/picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

using Eigen::Vector3d;

constexpr int num_shades = 64;
constexpr const char* install_povray = "install POV-Ray: apt-get install povray";

/// Viridis (van der Walt and Smith 2015) at nine places, linear between: lightness grows evenly, so it reads in grey too.
Vector3d shade(double t) {
  static const std::array<Vector3d, 9> stops = {
      Vector3d(0.267, 0.005, 0.329), {0.275, 0.195, 0.496}, {0.230, 0.322, 0.546},
      {0.173, 0.449, 0.558},         {0.128, 0.567, 0.551}, {0.158, 0.684, 0.502},
      {0.369, 0.789, 0.383},         {0.678, 0.864, 0.190}, {0.993, 0.906, 0.144}};
  const double at = std::clamp(t, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(stops.size() - 2, static_cast<std::size_t>(at));
  return stops[i] + (at - static_cast<double>(i)) * (stops[i + 1] - stops[i]);
}

/// Colour of a class: nearly white for the first, the others from dark to middling.
Vector3d class_colour(std::size_t number, std::size_t num_classes) {
  if (number == 0) return {0.93, 0.93, 0.91};
  return shade(num_classes > 2 ? 0.8 * static_cast<double>(number - 1) / static_cast<double>(num_classes - 2) : 0.2);
}

/// 1, 2 or 5 times a power of ten, at most `most`.
double round_down(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= most * (1 + 1e-9)) return digit * power;
  return power;
}

std::string pov(const Vector3d& v) { return fmt::format("<{:.6f},{:.6f},{:.6f}>", v[0], v[1], v[2]); }

/// What POV-Ray's built-in font can show.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c >= ' ' && c <= '~') out += (c == '"' || c == '\\') ? '\'' : c;
  return out;
}

/// The plane through the axis that cuts a drum open: what is on the side of `normal` is not drawn.
struct Cut {
  Vector3d normal;
  double at;
  bool away(const Vector3d& p) const { return normal.dot(p) > at; }
};

Vector3d axis_of(const Still::Drum& drum) { return (drum.end - drum.begin).normalized(); }

Cut cut_of(const Still::Drum& drum, const Vector3d& into) {
  const Vector3d axis = axis_of(drum);
  const Vector3d towards = -(into - axis * axis.dot(into)).normalized();
  // Turned a little about the axis: more stays of the lower part, in which the balls lie, and less of the upper one.
  Vector3d up = axis.cross(towards);
  if (up[2] < 0) up = -up;
  const Vector3d normal = (towards + 0.15 * up).normalized();
  return {normal, normal.dot(drum.outlet)};
}

/// The view: from beyond the outlet, from the side to which the belt moves and where the turning bed is low.
Vector3d viewer(const Still& still, const PictureOptions& options) {
  if (!still.drum) return Vector3d(0.55, -0.75, 0.42).normalized();
  return options.view == "outlet" ? Vector3d(0.86, 0.46, 0.36).normalized() : Vector3d(0.86, 0.44, 0.34).normalized();
}

/// Points that must be in the picture.
std::vector<Vector3d> corners(const Still& still, const PictureOptions& options, const Vector3d& into) {
  std::vector<Vector3d> points;
  if (still.drum) {
    const Still::Drum& drum = *still.drum;
    const Cut cut = cut_of(drum, into);
    const double from =
        options.view == "outlet" ? -0.25 * (drum.end - drum.outlet).norm() : -(drum.outlet - drum.begin).norm() - 1;
    for (const Still::Wall& wall : still.walls)
      for (const Vector3d& p : wall.mesh.vertices)
        if (wall.name != "drum" || (!cut.away(p) && axis_of(drum).dot(p - drum.outlet) >= from)) points.push_back(p);
    return points;
  }
  // Of a scene the balls, and what of the walls is near them: a ground may reach far.
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (std::size_t i = 0; i < still.balls.size(); ++i) {
    const Vector3d r = Vector3d::Constant(still.balls.radius[i]);
    low = low.cwiseMin(still.balls.position[i] - r);
    high = high.cwiseMax(still.balls.position[i] + r);
  }
  if (still.balls.size() > 0) {
    for (int k = 0; k < 8; ++k)
      points.emplace_back(k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]);
    const Vector3d room = Vector3d::Constant(0.15 * (high - low).norm());
    low -= room;
    high += room;
  }
  for (const Still::Wall& wall : still.walls)
    for (const Vector3d& p : wall.mesh.vertices)
      if (still.balls.size() == 0 || ((p.array() >= low.array()).all() && (p.array() <= high.array()).all()))
        points.push_back(p);
  return points;
}

/// Sizes in pixels that follow from the picture's.
struct Layout {
  double font, left, right, top, bottom;
};
Layout layout(const PictureOptions& options) {
  const double font = std::max(11.0, 0.021 * (options.width + options.height) / 2 * 1.25);
  return {font, 1.2 * font, 8.2 * font, 1.2 * font, 3.4 * font};
}

/// Glued to the ground of a scene; drawn like a wall.
bool is_fixed(const Still& still, std::size_t ball) {
  return still.balls.exit[ball] == static_cast<std::uint8_t>(Exit::fixed);
}

void choose_colours(const Still& still, const PictureOptions& options, PictureFrame& frame) {
  if (options.colour == "slot") {
    frame.classes = {"in the drum"};
    for (int k = 1; k <= still.drum->num_slots; ++k) frame.classes.push_back(fmt::format("slot {}", k));
    frame.classes.push_back("open end");
  } else if (options.colour == "axial") {
    frame.colour_label = "along the axis (m)";
    frame.high = (still.drum->end - still.drum->begin).norm();
    frame.tick = round_down(frame.high / 3);
  } else if (options.colour == "height") {
    frame.colour_label = "height (m)";
    double low = 1e300, high = -1e300;
    for (std::size_t i = 0; i < still.balls.size(); ++i) {
      if (is_fixed(still, i)) continue;
      low = std::min(low, still.balls.position[i][2]);
      high = std::max(high, still.balls.position[i][2]);
    }
    if (low > high) low = high = 0;
    const double step = frame.tick = round_down(std::max(1e-3, (high - low) / 3));
    frame.low = step * std::floor(low / step + 0.1);  // overlaps sink a little below 0
    frame.high = std::max(frame.low + step, step * std::ceil(high / step - 0.1));
  } else {
    frame.colour_label = "speed (m/s)";
    std::vector<double> speeds;
    for (std::size_t i = 0; i < still.balls.size(); ++i)
      if (!is_fixed(still, i)) speeds.push_back(still.balls.velocity[i].norm());
    std::sort(speeds.begin(), speeds.end());
    // Nearly all balls; a few fast ones would leave the rest in the dark.
    const double most = speeds.empty() ? 1 : speeds[(speeds.size() - 1) * 98 / 100];
    const double step = frame.tick = round_down(std::max(1e-3, most / 3));
    frame.high = step * std::ceil(std::max(1e-3, most) / step - 1e-9);
  }
}

/// Place on the colour scale or class of a ball, as the number of its texture.
std::size_t texture_of(const Still& still, std::size_t ball, const PictureOptions& options, const PictureFrame& frame) {
  if (options.colour == "slot") {
    const std::uint8_t exit = still.balls.exit[ball];
    return exit == static_cast<std::uint8_t>(Exit::end) ? frame.classes.size() - 1
                                                        : std::min<std::size_t>(exit, frame.classes.size() - 2);
  }
  if (is_fixed(still, ball)) return num_shades;
  const Vector3d& place = still.balls.position[ball];
  const double value = options.colour == "axial"    ? axis_of(*still.drum).dot(place - still.drum->begin)
                       : options.colour == "height" ? place[2]
                                                    : still.balls.velocity[ball].norm();
  const double share = (value - frame.low) / (frame.high - frame.low);
  return static_cast<std::size_t>(std::clamp(share * num_shades, 0.0, num_shades - 1.0));
}

/// Flat things drawn over the picture, in pixels from its upper left corner.
class Overlay {
 public:
  Overlay(const PictureOptions& options, const PictureFrame& frame) : options_(options), frame_(frame) {
    text_ = fmt::format(
        "#declare Ink = texture {{ pigment {{ srgb <0.13,0.13,0.15> }} finish {{ ambient 0 diffuse 0 emission 1 }} }}\n"
        "#macro Label(S, P, Size, Align, Turn)\n  #local T = text {{ internal 2 S 0.001, 0 }}\n"
        "  object {{ T translate <-Align*max_extent(T).x, -0.36, 0> rotate z*Turn scale Size\n"
        "    matrix <{},{},{},0,0,0> translate P texture {{ Ink }} no_shadow }}\n#end\n",
        inside(frame.right), inside(frame.up), inside(frame.into));
  }
  /// @param align  0: begins at x, 0.5: centred, 1: ends there
  void label(const std::string& text, double x, double y, double size, double align, double turn = 0) {
    ++num_things_;
    text_ += fmt::format("Label(\"{}\", {}, {:.8f}, {}, {})\n", plain(text), pov_at(x, y),
                         size * frame_.metres_per_pixel, align, turn);
  }
  void box(double x, double y, double width, double height, const Vector3d& colour) {
    ++num_things_;
    text_ += fmt::format(
        "mesh {{ triangle {{ {0}, {1}, {2} }} triangle {{ {0}, {2}, {3} }} pigment {{ srgb {4} }}\n"
        "  finish {{ ambient 0 diffuse 0 emission 1 }} no_shadow }}\n",
        pov_at(x, y), pov_at(x + width, y), pov_at(x + width, y + height), pov_at(x, y + height), pov(colour));
  }
  const std::string& text() const { return text_; }

 private:
  static std::string inside(const Vector3d& v) { return fmt::format("{:.9f},{:.9f},{:.9f}", v[0], v[1], v[2]); }
  std::string pov_at(double x, double y) const {
    const double step = frame_.metres_per_pixel;
    const Vector3d p = frame_.centre + (x - 0.5 * options_.width) * step * frame_.right -
                       (y - 0.5 * options_.height) * step * frame_.up -
                       (1.5 + 1e-4 * num_things_) * frame_.depth * frame_.into;
    return fmt::format("<{:.9f},{:.9f},{:.9f}>", p[0], p[1], p[2]);
  }
  const PictureOptions& options_;
  const PictureFrame& frame_;
  std::string text_;
  int num_things_ = 0;  ///< each is nearer than those before, so that it covers them
};

const Vector3d ink(0.13, 0.13, 0.15);

void add_colour_bar(Overlay& over, const PictureOptions& options, const PictureFrame& frame, const Layout& page) {
  const double x = options.width - page.right + 2.4 * page.font, width = 1.1 * page.font,
               height = 0.46 * options.height, top = 0.5 * (options.height - page.bottom - height) + page.top;
  over.label(frame.colour_label, options.width - page.right + 1.1 * page.font, top + 0.5 * height, page.font, 0.5, 90);
  for (int i = 0; i < num_shades; ++i) {
    const double from = std::round(top + height * (num_shades - 1 - i) / num_shades),
                 to = std::round(top + height * (num_shades - i) / num_shades);
    // Each reaches a little below the next, so that no light comes through between them.
    over.box(x, from, width, to - from + (i > 0 ? 1 : 0), shade((i + 0.5) / num_shades));
  }
  const double range = frame.high - frame.low;
  for (double value = frame.low; value <= frame.high + 1e-9 * range; value += frame.tick) {
    const double y = top + height * (1 - (value - frame.low) / range);
    over.box(x + width, y - 0.5, 0.35 * page.font, 1.2, ink);
    // What is beyond the scale has the colour of its end.
    const bool more = options.colour == "speed" && value > frame.high - 1e-9 * range;
    over.label(fmt::format("{:.4g}{}", value, more ? " +" : ""), x + width + 0.6 * page.font, y, page.font, 0);
  }
}

void add_classes(Overlay& over, const PictureOptions& options, const PictureFrame& frame, const Layout& page) {
  const double x = options.width - page.right + 0.6 * page.font, line = 1.7 * page.font;
  double y = 0.5 * (options.height - page.bottom - line * static_cast<double>(frame.classes.size()));
  over.label("way out", x, y, page.font, 0);
  for (std::size_t i = 0; i < frame.classes.size(); ++i) {
    y += line;
    over.box(x, y - 0.5 * page.font, page.font, page.font, ink);
    over.box(x + 1, y - 0.5 * page.font + 1, page.font - 2, page.font - 2, class_colour(i, frame.classes.size()));
    over.label(frame.classes[i], x + 1.5 * page.font, y, page.font, 0);
  }
}

void add_scale_bar(Overlay& over, const PictureOptions& options, const PictureFrame& frame, const Layout& page,
                   const std::string& caption) {
  const double length = round_down(0.25 * options.width * frame.metres_per_pixel);
  const double pixels = length / frame.metres_per_pixel, y = options.height - 1.5 * page.font,
               thick = std::max(3.0, 0.28 * page.font);
  over.box(page.left, y - 0.5 * thick, pixels, thick, ink);
  // Half of it white, as on maps: it is not taken for a part of the drum.
  over.box(page.left + 0.5 * pixels, y - 0.5 * thick + 1, 0.5 * pixels - 1, thick - 2, {1, 1, 1});
  over.label(fmt::format("{:g} m", length), page.left + pixels + 0.6 * page.font, y, page.font, 0);
  over.label(caption, options.width - page.left, y, page.font, 1);
}

/// Area-weighted normals of the vertices, for smooth shading.
std::vector<Vector3d> normals_of(const TriangleMesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices.size(), Vector3d::Zero());
  const auto at = [&](std::int32_t i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
  for (const auto& t : mesh.triangles) {
    const Vector3d area = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    for (const std::int32_t corner : t) normals[static_cast<std::size_t>(corner)] += area;
  }
  for (Vector3d& n : normals) n = n.squaredNorm() > 0 ? n.normalized() : Vector3d(0, 0, 1);
  return normals;
}

/// @param more  what follows the faces: clipping, texture
/// @param shown  of a triangle's corners and front normal: whether it is drawn
template <class Shown>
std::string pov_mesh(const TriangleMesh& mesh, bool smooth, const std::string& more, const Shown& shown) {
  std::string out = fmt::format("mesh2 {{ vertex_vectors {{ {}", mesh.vertices.size()), faces;
  for (const Vector3d& v : mesh.vertices) out += "," + pov(v);
  out += " }\n";
  if (smooth) {
    out += fmt::format("normal_vectors {{ {}", mesh.vertices.size());
    for (const Vector3d& n : normals_of(mesh)) out += "," + pov(n);
    out += " }\n";
  }
  std::size_t num = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[static_cast<std::size_t>(t[0])],
                   &b = mesh.vertices[static_cast<std::size_t>(t[1])],
                   &c = mesh.vertices[static_cast<std::size_t>(t[2])];
    if (!shown(a, b, c)) continue;
    faces += fmt::format(",<{},{},{}>", t[0], t[1], t[2]);
    ++num;
  }
  if (num == 0) return "";
  return out + fmt::format("face_indices {{ {}{} }}\n{} }}\n", num, faces, more);
}

const char* const drum_texture =
    "texture { pigment { srgb <0.80,0.79,0.77> } finish { ambient 0.16 diffuse 0.62 } }\n"
    "interior_texture { pigment { srgb <0.56,0.57,0.60> } finish { ambient 0.16 diffuse 0.55 } }";
const char* const belt_texture = "texture { pigment { srgb <0.72,0.75,0.79> } finish { ambient 0.2 diffuse 0.6 } }";

std::string pov_walls(const Still& still, const PictureFrame& frame) {
  std::string out;
  for (const Still::Wall& wall : still.walls) {
    if (still.drum && wall.name == "drum") {
      const Cut cut = cut_of(*still.drum, frame.into);
      // The plane cuts exactly; triangles wholly on the near side are left out beforehand.
      const std::string clip = fmt::format("clipped_by {{ plane {{ {}, {:.6f} }} }}\n", pov(cut.normal), cut.at);
      out += pov_mesh(wall.mesh, true, clip + drum_texture, [&](const auto& a, const auto& b, const auto& c) {
        return !(cut.away(a) && cut.away(b) && cut.away(c));
      });
    } else if (still.drum && wall.name == "belt") {
      const Vector3d down(0, 0, 0.06 * still.drum->radius);
      out += fmt::format("box {{ {}, {} {} }}\n", pov(wall.mesh.vertices.front() - down), pov(wall.mesh.vertices[2]),
                         belt_texture);
    } else {
      out += pov_mesh(wall.mesh, false, drum_texture, [&](const auto& a, const auto& b, const auto& c) {
        return (b - a).cross(c - a).dot(frame.into) < 0;
      });
    }
  }
  return out;
}

/// @param drawn, drawn_frame  in the picture's units; the others in metres, for the colours
std::string pov_balls(const Still& still, const PictureOptions& options, const PictureFrame& frame, const Still& drawn,
                      const PictureFrame& drawn_frame) {
  std::string out;
  const bool classes = !frame.classes.empty();
  const std::size_t num = classes ? frame.classes.size() : num_shades + 1;
  for (std::size_t i = 0; i < num; ++i) {
    const Vector3d c = classes           ? class_colour(i, num)
                       : i == num_shades ? Vector3d(0.72, 0.72, 0.71)
                                         : shade((static_cast<double>(i) + 0.5) / num_shades);
    out += fmt::format(
        "#declare T{} = texture {{ pigment {{ srgb {} }} finish {{ ambient 0.24 diffuse 0.72 specular 0.12 roughness "
        "0.03 }} }}\n",
        i, pov(c));
  }
  const double half_width = 0.5 * drawn_frame.metres_per_pixel * options.width,
               half_height = 0.5 * drawn_frame.metres_per_pixel * options.height;
  for (std::size_t i = 0; i < drawn.balls.size(); ++i) {
    const Vector3d& p = drawn.balls.position[i];
    const double r = drawn.balls.radius[i];
    // Outside of the picture; their shadows are missed by nobody.
    if (std::abs(p.dot(frame.right)) > half_width + 4 * r || std::abs(p.dot(frame.up)) > half_height + 4 * r) continue;
    out += fmt::format("sphere {{ {}, {:.6f} texture {{ T{} }} }}\n", pov(p), r, texture_of(still, i, options, frame));
  }
  return out;
}

/// A hundred pixels are one unit, the picture's centre is the origin: POV-Ray takes what is small in its units for nothing.
constexpr double units_per_pixel = 0.01;

/// Balls and walls in these units.
Still in_picture_units(const Still& still, const PictureFrame& frame) {
  Still out = still;
  const double scale = units_per_pixel / frame.metres_per_pixel;
  const auto move = [&](Vector3d& p) { p = (p - frame.centre) * scale; };
  for (Vector3d& p : out.balls.position) move(p);
  for (double& r : out.balls.radius) r *= scale;
  for (Still::Wall& wall : out.walls)
    for (Vector3d& p : wall.mesh.vertices) move(p);
  if (out.drum) {
    move(out.drum->begin);
    move(out.drum->outlet);
    move(out.drum->end);
    out.drum->radius *= scale;
  }
  return out;
}

PictureFrame in_picture_units(PictureFrame frame) {
  frame.depth *= units_per_pixel / frame.metres_per_pixel;
  frame.centre.setZero();
  frame.metres_per_pixel = units_per_pixel;
  return frame;
}

}  // namespace

PictureFrame picture_frame(const Still& still, const PictureOptions& options) {
  if (!still.drum && (options.colour == "slot" || options.colour == "axial"))
    throw InputError(fmt::format("--colour {}: only a drum has that; accepted for the scene {}: speed, height",
                                 options.colour, still.name));
  if (!still.drum && options.view != "all")
    throw InputError(
        fmt::format("--view {}: only a drum has that; accepted for the scene {} is all", options.view, still.name));
  PictureFrame frame;
  frame.into = -viewer(still, options);
  frame.right = frame.into.cross(Vector3d(0, 0, 1)).normalized();
  frame.up = frame.right.cross(frame.into);
  const std::vector<Vector3d> points = corners(still, options, frame.into);
  if (points.empty()) throw InputError(still.name + ": has neither balls nor walls to draw");

  // What must be seen fills the page up to its margins.
  Eigen::Matrix3d axes;
  axes.row(0) = frame.right;
  axes.row(1) = frame.up;
  axes.row(2) = frame.into;
  Vector3d low = axes * points.front(), high = low;
  for (const Vector3d& p : points) {
    low = low.cwiseMin(axes * p);
    high = high.cwiseMax(axes * p);
  }
  const Layout page = layout(options);
  const double width = options.width - page.left - page.right, height = options.height - page.top - page.bottom;
  frame.metres_per_pixel = std::max({(high[0] - low[0]) / width, (high[1] - low[1]) / height, 1e-9});
  Vector3d middle = 0.5 * (low + high);
  middle[0] += 0.5 * (page.right - page.left) * frame.metres_per_pixel;
  middle[1] -= 0.5 * (page.bottom - page.top) * frame.metres_per_pixel;
  frame.centre = axes.transpose() * middle;
  // Everything, the far part of walls outside of the picture too.
  for (const Still::Wall& wall : still.walls)
    for (const Vector3d& p : wall.mesh.vertices) frame.depth = std::max(frame.depth, (p - frame.centre).norm());
  frame.depth = std::max(frame.depth, (high - low).norm()) * 1.5;
  choose_colours(still, options, frame);
  return frame;
}

std::string pov_scene(const Still& still, const PictureOptions& options, const PictureFrame& frame,
                      const std::string& caption) {
  const Still drawn = in_picture_units(still, frame);
  const PictureFrame page_frame = in_picture_units(frame);
  const double size = page_frame.metres_per_pixel * std::hypot(options.width, options.height);
  const auto light = [&](double right, double up, double back) -> Vector3d {
    return page_frame.centre + 4 * size * (right * page_frame.right + up * page_frame.up - back * page_frame.into);
  };
  const std::string area = fmt::format("area_light {}, {}, 4, 4 adaptive 1 circular orient",
                                       pov(0.5 * size * page_frame.right), pov(0.5 * size * page_frame.up));
  // The vectors are given outright: with them POV-Ray's left-handed axes need no thought.
  std::string out = fmt::format(
      "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 5 }}\nbackground {{ rgb 1 }}\n"
      "camera {{ orthographic location {} direction {} right {} up {} }}\n"
      "light_source {{ {} rgb 0.98 {} }}\n"
      "light_source {{ {} rgb 0.38 shadowless }}\n",
      pov(page_frame.centre - 2 * page_frame.depth * page_frame.into), pov(page_frame.into),
      pov(options.width * page_frame.metres_per_pixel * page_frame.right),
      pov(options.height * page_frame.metres_per_pixel * page_frame.up), pov(light(-0.3, 0.5, 1.0)),
      options.soft_shadows ? area : "", pov(light(0.7, 0.9, 0.4)));
  out += pov_walls(drawn, page_frame) + pov_balls(still, options, frame, drawn, page_frame);

  Overlay over(options, page_frame);
  const Layout page = layout(options);
  if (frame.classes.empty())
    add_colour_bar(over, options, frame, page);
  else
    add_classes(over, options, frame, page);
  add_scale_bar(over, options, frame, page, caption);
  return out + over.text();
}

std::string rendered(const Still& still, const PictureOptions& options, const PictureFrame& frame,
                     const std::string& caption) {
  const ScratchFolder scratch;
  write_durably((scratch.path / "scene.pov").string(), pov_scene(still, options, frame, caption));
  run_program(scratch.path,
              {"povray", "+Iscene.pov", "+Opicture.png", fmt::format("+W{}", options.width),
               fmt::format("+H{}", options.height), "+A0.2", "+AM2", "+R2", "-D", "-GA"},
              install_povray);
  return read_whole_file((scratch.path / "picture.png").string());
}

void write_picture(const Still& still, const PictureOptions& options, const std::string& path) {
  const std::string caption = fmt::format("{}, {} balls, t = {:.2f} s", still.name, still.balls.size(), still.time_s);
  write_durably(path, rendered(still, options, picture_frame(still, options), caption));
}

void need_povray() { need_program("povray", install_povray); }

}  // namespace drumsweep
