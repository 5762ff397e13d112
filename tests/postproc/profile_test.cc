#include "postproc/profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/schema.h"
#include "support/complaint.h"

namespace drumsweep {
namespace {

Profile belt_profile(std::size_t num_cells, double width_m) {
  Profile profile{width_m / static_cast<double>(num_cells), 0.0, {}};
  for (std::size_t j = 0; j < num_cells; ++j) profile.height_m.push_back(static_cast<double>(j));
  return profile;
}

TEST(Profile, footprint_of_the_lab_outlet_is_30_cells_from_150_to_900_mm) {
  const Profile inside = footprint(belt_profile(40, 1.0), BeltConfig{}, 0.75, 7.5);
  ASSERT_EQ(inside.height_m.size(), 30U);
  EXPECT_NEAR(inside.y_begin_m, 0.150, 1e-12);
  EXPECT_NEAR(inside.centre_m(29), 0.8875, 1e-12);
  EXPECT_EQ(inside.height_m.front(), 6.0);
}

TEST(Profile, footprint_drops_the_last_of_an_odd_number_of_cells) {
  EXPECT_EQ(footprint(belt_profile(40, 1.0), BeltConfig{}, 0.725, 0.0).height_m.size(), 28U);  // 29 centres inside
}

TEST(Profile, footprint_ends_at_the_edge_of_the_belt) {
  EXPECT_EQ(footprint(belt_profile(40, 1.0), BeltConfig{}, 5.0, 0.0).height_m.size(), 34U);
}

TEST(Profile, footprint_without_cells_is_refused_by_name) {
  BeltConfig belt;
  belt.outlet_begin_m = 2.0;
  const std::string text = complaint([&] { footprint(belt_profile(40, 1.0), belt, 0.75, 7.5); });
  EXPECT_NE(text.find("belt.outlet_begin_m = 2"), std::string::npos) << text;
}

TEST(Profile, mean_of_block_profiles_is_the_mean_profile) {
  Bed bed;
  bed.grid = {6, 4, 0.025, 0.025};
  for (int k = 0; k < 24; ++k) bed.height_m.push_back(std::sin(k));
  const std::vector<Profile> blocks = block_profiles(bed, 3);
  const Profile mean = mean_profile(bed);
  ASSERT_EQ(blocks.size(), 3U);
  for (std::size_t j = 0; j < 4; ++j)
    EXPECT_NEAR((blocks[0].height_m[j] + blocks[1].height_m[j] + blocks[2].height_m[j]) / 3.0, mean.height_m[j], 1e-15);
  EXPECT_THROW(block_profiles(bed, 4), std::invalid_argument);
}

TEST(Profile, standard_error_is_that_of_the_mean_of_blocks) {
  const std::vector<Profile> blocks = {{0.025, 0.0, {1.0}}, {0.025, 0.0, {2.0}}, {0.025, 0.0, {6.0}}};
  // Mean 3, s^2 = (4 + 1 + 9) / 2 = 7.
  EXPECT_NEAR(standard_error(blocks)[0], std::sqrt(7.0 / 3.0), 1e-15);
}

}  // namespace
}  // namespace drumsweep
