#include "core/contact/wall_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace drumsweep {
namespace {

constexpr double same_direction = 0.985;  // cosine of 10 degrees
constexpr double nearer = 1 - 1e-10;      // on squared distances: beyond rounding
constexpr double rounding = 1 - 1e-6;     // on lengths kept in float

struct Candidate {
  std::int32_t triangle;
  Feature feature;
  double squared;
  Eigen::Vector3d point;
};

bool on_border(const TriangleMesh& mesh, const Candidate& c) {
  // Features count edges from 1 and vertices from 4, the bits both from 0.
  return c.feature != Feature::face &&
         (mesh.border[static_cast<std::size_t>(c.triangle)] >> (static_cast<int>(c.feature) - 1) & 1) != 0;
}

Eigen::Vector3d front_of(const TriangleMesh& mesh, std::int32_t triangle) {
  const auto& [i, j, k] = mesh.triangles[static_cast<std::size_t>(triangle)];
  const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(i)];
  return (mesh.vertices[static_cast<std::size_t>(j)] - a)
      .cross(mesh.vertices[static_cast<std::size_t>(k)] - a)
      .normalized();
}

}  // namespace

void wall_contacts(const TriangleMesh& mesh, std::span<const std::int32_t> candidates, const Eigen::Vector3d& centre,
                   double max_distance, bool in_front, std::vector<WallContact>& contacts, const WallSight& sight) {
  contacts.clear();

  // Closest point on each triangle; those out of range cannot matter to the others.
  std::array<Candidate, 64> near;
  std::size_t num_near = 0;
  const double range = max_distance * max_distance;
  const bool remembers = !sight.reached_after.empty();
  for (std::size_t n = 0; n < candidates.size(); ++n) {
    if (remembers && sight.reached_after[n] > sight.travelled + max_distance) continue;
    const std::int32_t t = candidates[n];
    const auto& [i, j, k] = mesh.triangles[static_cast<std::size_t>(t)];
    const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(i)];
    const Eigen::Vector3d& b = mesh.vertices[static_cast<std::size_t>(j)];
    const Eigen::Vector3d& c = mesh.vertices[static_cast<std::size_t>(k)];
    const ClosestPoint closest = closest_point(centre, a, b, c);
    const double squared = (centre - closest.point).squaredNorm();
    if (remembers) sight.reached_after[n] = static_cast<float>((sight.travelled + std::sqrt(squared)) * rounding);
    if (squared > range) continue;
    const Candidate candidate{t, closest.feature, squared, closest.point};
    if (num_near < near.size()) {
      near[num_near++] = candidate;
    } else {
      // Only on meshes much finer than a ball: keep the nearest.
      const auto farthest = std::max_element(near.begin(), near.end(),
                                             [](const auto& l, const auto& r) { return l.squared < r.squared; });
      if (squared < farthest->squared) *farthest = candidate;
    }
  }
  const std::span<Candidate> found(near.data(), num_near);

  // Local minima of the distance, nearest first (ties in the order of triangles).
  std::sort(found.begin(), found.end(), [](const Candidate& l, const Candidate& r) {
    return l.squared != r.squared ? l.squared < r.squared : l.triangle < r.triangle;
  });
  for (const Candidate& c : found) {
    const auto& corners = mesh.triangles[static_cast<std::size_t>(c.triangle)];
    const auto shares = [&](const Candidate& other) {
      if (c.feature == Feature::face || other.triangle == c.triangle) return false;
      const auto& theirs = mesh.triangles[static_cast<std::size_t>(other.triangle)];
      const auto has = [&](std::size_t k) {
        const std::int32_t vertex = corners[k % 3];
        return theirs[0] == vertex || theirs[1] == vertex || theirs[2] == vertex;
      };
      const auto k = static_cast<std::size_t>(c.feature);
      return c.feature <= Feature::edge2 ? has(k - 1) && has(k) : has(k - 4);
    };
    const bool held_by_neighbour = std::any_of(
        found.begin(), found.end(), [&](const Candidate& o) { return o.squared < c.squared * nearer && shares(o); });
    if (held_by_neighbour) continue;

    // Normal towards the ball; where it must be in front but is behind, the other way, so that it is pushed back. Around the border of a
    // wall there is no behind.
    const Eigen::Vector3d away = centre - c.point, front = front_of(mesh, c.triangle);
    const bool behind = front.dot(away) < 0;
    // On an edge or vertex all triangles that share it must agree: in front of a sharp ridge one is behind its far side's plane.
    const bool turned =
        in_front && behind && !on_border(mesh, c) && std::none_of(found.begin(), found.end(), [&](const Candidate& o) {
          return shares(o) && front_of(mesh, o.triangle).dot(away) >= 0;
        });
    Eigen::Vector3d normal = behind ? Eigen::Vector3d(-front) : front;
    if (c.feature != Feature::face) {
      if (c.squared == 0) continue;  // exactly on an edge: no direction; the faces beside it hold the contact
      normal = away / std::sqrt(c.squared);
    }
    const double distance = turned ? -std::sqrt(c.squared) : std::sqrt(c.squared);
    if (turned) normal = -normal;
    const bool repeated = std::any_of(contacts.begin(), contacts.end(),
                                      [&](const WallContact& w) { return w.normal.dot(normal) > same_direction; });
    if (!repeated && contacts.size() < max_wall_contacts) contacts.push_back({normal, distance});
  }
  std::sort(contacts.begin(), contacts.end(),
            [](const WallContact& l, const WallContact& r) { return l.distance < r.distance; });
}

}  // namespace drumsweep
