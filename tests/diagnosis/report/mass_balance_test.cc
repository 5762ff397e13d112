#include "diagnosis/report/mass_balance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace drumsweep {
namespace {

constexpr double diameter = 0.012, density = 2500;
const double ball_kg = density * std::numbers::pi / 6 * std::pow(diameter, 3);

Condition condition(const std::string& id, const std::string& scene) {
  Condition c;
  c.id = id;
  c.path = id + ".toml";
  c.text = fmt::format("[scene]\n{}[material]\ndiameter_m = {}\ndensity_kg_m3 = {}\nfriction = 0.5\n", scene, diameter,
                       density);
  return c;
}

Datum datum(const std::string& condition, const std::string& quantity, double value, double sigma) {
  Datum d;
  d.condition = condition;
  d.quantity = quantity;
  d.value = value;
  d.sigma = sigma;
  return d;
}

/// A fed drum, a belt and a pile.
Campaign three_conditions() {
  Campaign c;
  c.conditions = {
      condition("drum",
                "type = \"drum\"\ndiameter_m = 0.3\nlength_m = 0.5\nends = \"open_fed\"\nfeed_kg_s = 0.2\n"
                "feed_zone_length_m = 0.1\nfeed_zone_width_m = 0.1\nangular_velocity_rad_s = 3\n"),
      condition("belt",
                "type = \"conveyor\"\nwidth_m = 0.2\nbelt_speed_m_s = 0.25\nfeed_rate_kg_s = 0.5\npacking = 0.6\n"
                "band_end_m = 0.2\n"),
      condition("pile", "type = \"pile\"\nmass_kg = 0.4\n")};
  return c;
}

}  // namespace

TEST(MassBalances, close_where_numbers_are_those_of_one_steady_flow) {
  const double residence_s = 12, holdup = 0.2 * residence_s / ball_kg, velocity = 0.5 / residence_s;
  Problem problem;
  problem.data = {datum("drum", "holdup", holdup, 0.02 * holdup),
                  datum("drum", "residence_time", residence_s, 0.03 * residence_s),
                  datum("drum", "axial_velocity", velocity, 0.04 * velocity),
                  datum("drum", "outflow_over_feed", 1, 0.05),
                  datum("belt", "mean_height", 0.5 / (0.2 * 0.25 * 0.6 * density), 1e-4),
                  datum("pile", "mass_on_base", 0.3, 0.003),
                  datum("pile", "mass_left_base", 0.1, 0.004)};
  const std::vector<MassBalance> list = mass_balances(three_conditions(), problem, {});
  ASSERT_EQ(list.size(), 5u);
  for (const MassBalance& b : list) {
    EXPECT_NEAR(b.measured, 1, 1e-9) << b.what;
    EXPECT_TRUE(b.closes()) << b.what;
    EXPECT_TRUE(std::isnan(b.simulated)) << b.what;
  }
  // Errors add up as those of independent numbers.
  EXPECT_NEAR(list[1].sigma, std::hypot(0.02, 0.03), 1e-9);
  EXPECT_NEAR(list[2].sigma, std::hypot(0.02, 0.04), 1e-9);
  EXPECT_NEAR(list[4].sigma, 0.005 / 0.4, 1e-9);
}

TEST(MassBalances, do_not_close_where_a_number_is_off_and_say_what_was_simulated) {
  Problem problem;
  problem.data = {datum("drum", "outflow_over_feed", 0.8, 0.05), datum("belt", "bed_height", 0.02, 1e-4)};
  std::vector<DatumMisfit> misfits(2);
  misfits[0].simulated_before = 1.01;
  const std::vector<MassBalance> list = mass_balances(three_conditions(), problem, misfits);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_FALSE(list[0].closes());
  EXPECT_NEAR(list[0].simulated, 1.01, 1e-12);
  // What is only available was not measured.
  problem.data[0].use = Use::available;
  EXPECT_TRUE(mass_balances(three_conditions(), problem, misfits).empty());
}

}  // namespace drumsweep
