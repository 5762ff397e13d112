/// Balls of different size: each has a radius drawn by its id, so feed and restart do not change it.
#pragma once

#include <cstdint>

#include "core/config/study.h"

namespace drumsweep {

/// Radius of ball `id`: normal or lognormal diameter with mean material.diameter_m and standard deviation effects.size_spread times
/// that, drawn again while farther than size_cut standard deviations from the mean (the logarithm's, for lognormal).
double radius_of_ball(const Physics& physics, std::uint32_t id);

double smallest_radius(const Physics& physics);
double largest_radius(const Physics& physics);

/// Mean mass of a ball: density pi/6 <d^3>, the distribution's own moment [kg].
double mean_ball_mass(const Physics& physics);

}  // namespace drumsweep
