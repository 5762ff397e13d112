/// Convex polygons in the plane: hulls, the part of the plane nearest to a design, hatching. Coordinates are such that
/// distances mean something: callers divide each variable by its range.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "postproc/contour_lines.h"

namespace drumsweep {

/// Convex, anticlockwise, first corner not repeated; two corners for a line, one for a point, none for nothing.
using Polygon = std::vector<PlanePoint>;

/// Andrew's monotone chain. Points within the hull's edges are left out.
Polygon convex_hull(std::vector<PlanePoint> points);

double area(const Polygon& polygon);

/// With its edge, and a margin of 1e-9 around it.
bool inside(const Polygon& polygon, PlanePoint at);

/// The part with a x + b y <= c (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, double a, double b, double c);

/// A design seen from a plane: its projection, and its squared distance from the plane, which is 0 for designs in it.
struct PlaneSite {
  PlanePoint at;
  double off_plane_squared = 0;
};

/// Position of the site nearest to a point of the plane, the first of equals. @pre there is one
std::size_t nearest_site(std::span<const PlaneSite> sites, PlanePoint at);

/// The part of `within` that is nearest to sites[i]: its Voronoi cell, cut by the plane. Sites at the same place share
/// their cell.
Polygon nearest_region(std::span<const PlaneSite> sites, std::size_t i, const Polygon& within);

using Segment = std::pair<PlanePoint, PlanePoint>;

/// Parallel lines x - y = k * spacing * sqrt 2 through the union of the polygons. As the lines are the same for all
/// polygons, neighbours share them, and where polygons overlap a line is there once.
std::vector<Segment> hatching(std::span<const Polygon> polygons, double spacing);

/// Convex hull of `share` of the points: those farthest from their mean, in the metric of their covariance, are left
/// out. It holds at least that share of them and nothing outside their own hull. For a region of a cloud of draws.
Polygon hull_of_most(std::span<const PlanePoint> points, double share);

/// The convex hull of points (each num_dimensions), cut where the coordinates of `fixed` have their values, as points
/// whose hull in the remaining coordinates is that cut. Of many points only those that are extreme in some direction
/// are taken, so the cut may be too small by a little, never too large.
/// @param fixed  (num_dimensions) NaN for a free coordinate
std::vector<std::vector<double>> cut_of_hull(std::vector<std::vector<double>> points, const std::vector<double>& fixed);

}  // namespace drumsweep
