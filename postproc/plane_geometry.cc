#include "postproc/plane_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace drumsweep {
namespace {

/// Twice the area of the triangle, > 0 when it turns left.
double turn(PlanePoint a, PlanePoint b, PlanePoint c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

double squared_distance(PlanePoint a, PlanePoint b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// Points that are extreme in one of many directions: the hull of these lies in the hull of all.
void keep_extreme_points(std::vector<std::vector<double>>& points) {
  constexpr std::size_t enough = 300, num_directions = 600;
  if (points.size() <= enough) return;
  const std::size_t d = points.front().size();
  std::set<std::size_t> kept;
  for (std::size_t k = 0; k < num_directions; ++k) {
    // Evenly spread by the roots of primes; the axes first, in both senses.
    std::vector<double> direction(d);
    for (std::size_t c = 0; c < d; ++c) {
      static constexpr double roots[] = {1.4142135623730951, 1.7320508075688772, 2.23606797749979, 2.6457513110645907,
                                         3.3166247903554,    3.605551275463989,  4.123105625617661};
      const double share = static_cast<double>(k) * roots[c % 7];
      direction[c] = k < 2 * d ? (k / 2 == c ? (k % 2 == 0 ? 1.0 : -1.0) : 0.0) : 2 * (share - std::floor(share)) - 1;
    }
    std::size_t best = 0;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
      double along = 0;
      for (std::size_t c = 0; c < d; ++c) along += direction[c] * points[i][c];
      if (along <= highest) continue;
      highest = along;
      best = i;
    }
    kept.insert(best);
  }
  std::vector<std::vector<double>> fewer;
  for (const std::size_t i : kept) fewer.push_back(std::move(points[i]));
  points = std::move(fewer);
}

}  // namespace

Polygon convex_hull(std::vector<PlanePoint> points) {
  const auto before = [](PlanePoint a, PlanePoint b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  const auto same = [](PlanePoint a, PlanePoint b) { return a.x == b.x && a.y == b.y; };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  if (points.size() < 3) return points;
  // Lower, then upper chain.
  Polygon hull;
  for (const bool upper : {false, true}) {
    const std::size_t begin = hull.size();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const PlanePoint p = upper ? points[points.size() - 1 - k] : points[k];
      while (hull.size() >= begin + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
  }
  return hull;
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) twice += turn({0, 0}, polygon[k], polygon[(k + 1) % polygon.size()]);
  return 0.5 * twice;
}

bool inside(const Polygon& polygon, PlanePoint at) {
  constexpr double margin = 1e-9;
  if (polygon.empty()) return false;
  if (polygon.size() < 3) {
    // Between the ends of a line.
    const PlanePoint a = polygon.front(), b = polygon.back();
    const double length = std::sqrt(squared_distance(a, b));
    return std::sqrt(squared_distance(a, at)) + std::sqrt(squared_distance(b, at)) <= length + margin;
  }
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const PlanePoint a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    if (turn(a, b, at) < -margin * std::sqrt(squared_distance(a, b))) return false;
  }
  return true;
}

Polygon clipped(const Polygon& polygon, double a, double b, double c) {
  Polygon out;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const PlanePoint p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
    if (at_p <= 0) out.push_back(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
      const double share = at_p / (at_p - at_q);
      out.push_back({p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)});
    }
  }
  return out;
}

std::size_t nearest_site(std::span<const PlaneSite> sites, PlanePoint at) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const double distance = squared_distance(sites[i].at, at) + sites[i].off_plane_squared;
    if (distance >= least) continue;
    least = distance;
    best = i;
  }
  return best;
}

Polygon nearest_region(std::span<const PlaneSite> sites, std::size_t i, const Polygon& within) {
  Polygon region = within;
  const PlaneSite& own = sites[i];
  for (std::size_t k = 0; k < sites.size() && !region.empty(); ++k) {
    const PlaneSite& other = sites[k];
    const double dx = other.at.x - own.at.x, dy = other.at.y - own.at.y;
    // |r - own|^2 + own's distance^2 <= |r - other|^2 + other's distance^2
    // As a product, so that it is exactly 0 for a site at the same place.
    const double bound = 0.5 * (dx * (other.at.x + own.at.x) + dy * (other.at.y + own.at.y) + other.off_plane_squared -
                                own.off_plane_squared);
    region = clipped(region, dx, dy, bound);
  }
  return region;
}

std::vector<Segment> hatching(std::span<const Polygon> polygons, double spacing) {
  // u along the lines, v across them.
  const double half = std::sqrt(0.5);
  const auto turned = [&](PlanePoint p) { return PlanePoint{half * (p.x + p.y), half * (p.x - p.y)}; };
  const auto back = [&](double u, double v) { return PlanePoint{half * (u + v), half * (u - v)}; };
  std::vector<Polygon> all;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Polygon& polygon : polygons) {
    if (polygon.size() < 3) continue;
    all.emplace_back();
    for (const PlanePoint& p : polygon) {
      all.back().push_back(turned(p));
      low = std::min(low, all.back().back().y);
      high = std::max(high, all.back().back().y);
    }
  }
  std::vector<Segment> lines;
  if (all.empty()) return lines;
  for (double k = std::ceil(low / spacing); k * spacing <= high; ++k) {
    const double v = k * spacing;
    std::vector<std::pair<double, double>> pieces;
    for (const Polygon& polygon : all) {
      double from = std::numeric_limits<double>::infinity(), to = -from;
      for (std::size_t c = 0; c < polygon.size(); ++c) {
        const PlanePoint p = polygon[c], q = polygon[(c + 1) % polygon.size()];
        if ((p.y < v && q.y < v) || (p.y > v && q.y > v) || p.y == q.y) continue;
        const double u = p.x + (v - p.y) / (q.y - p.y) * (q.x - p.x);
        from = std::min(from, u);
        to = std::max(to, u);
      }
      if (from < to) pieces.emplace_back(from, to);
    }
    std::sort(pieces.begin(), pieces.end());
    for (std::size_t p = 0; p < pieces.size();) {
      double to = pieces[p].second;
      std::size_t next = p + 1;
      for (; next < pieces.size() && pieces[next].first <= to + 1e-9; ++next) to = std::max(to, pieces[next].second);
      lines.emplace_back(back(pieces[p].first, v), back(to, v));
      p = next;
    }
  }
  return lines;
}

Polygon hull_of_most(std::span<const PlanePoint> points, double share) {
  if (points.empty()) return {};
  const double n = static_cast<double>(points.size());
  PlanePoint mean;
  for (const PlanePoint& p : points) {
    mean.x += p.x / n;
    mean.y += p.y / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (const PlanePoint& p : points) {
    xx += (p.x - mean.x) * (p.x - mean.x) / n;
    xy += (p.x - mean.x) * (p.y - mean.y) / n;
    yy += (p.y - mean.y) * (p.y - mean.y) / n;
  }
  // A cloud that is a line has no inverse; along it the floor changes nothing.
  const double floor = 1e-9 * (xx + yy) + std::numeric_limits<double>::min();
  xx += floor;
  yy += floor;
  const double determinant = xx * yy - xy * xy;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double dx = points[i].x - mean.x, dy = points[i].y - mean.y;
    order.emplace_back((yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant, i);
  }
  std::sort(order.begin(), order.end());
  const auto kept = static_cast<std::size_t>(std::ceil(share * n - 1e-9));
  std::vector<PlanePoint> inner;
  for (std::size_t k = 0; k < std::min(kept, order.size()); ++k) inner.push_back(points[order[k].second]);
  return convex_hull(std::move(inner));
}

std::vector<std::vector<double>> cut_of_hull(std::vector<std::vector<double>> points,
                                             const std::vector<double>& fixed) {
  for (std::size_t c = 0; c < fixed.size(); ++c) {
    if (std::isnan(fixed[c])) continue;
    keep_extreme_points(points);
    // The cut of a hull by x_c = value is the hull of the cuts of all lines between its points.
    std::vector<std::vector<double>> cut;
    for (const std::vector<double>& p : points) {
      if (p[c] == fixed[c]) cut.push_back(p);
      if (!(p[c] < fixed[c])) continue;
      for (const std::vector<double>& q : points) {
        if (!(q[c] > fixed[c])) continue;
        const double share = (fixed[c] - p[c]) / (q[c] - p[c]);
        std::vector<double> between(p.size());
        for (std::size_t k = 0; k < p.size(); ++k) between[k] = p[k] + share * (q[k] - p[k]);
        between[c] = fixed[c];
        cut.push_back(std::move(between));
      }
    }
    points = std::move(cut);
  }
  std::vector<std::vector<double>> free;
  for (const std::vector<double>& p : points) {
    free.emplace_back();
    for (std::size_t c = 0; c < fixed.size(); ++c)
      if (std::isnan(fixed[c])) free.back().push_back(p[c]);
  }
  return free;
}

}  // namespace drumsweep
