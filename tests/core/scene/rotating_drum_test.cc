#include "core/scene/rotating_drum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/scene/scene_run.h"
#include "core/scene/slice_field.h"
#include "support/scene_text.h"

namespace drumsweep {
namespace {

// --- periodic world

/// Soft balls that rain into a trough along y.
SceneRun rain(const std::string& method, double shift) {
  Physics p;
  p.step.method = method;
  p.solver.outer_step_s = 0.002;
  World world(p, 0.5);
  world.set_period(0.05);
  world.add_wall(box_mesh({-0.03, -0.06, 0}, {0.03, 0.11, 0.1}, {true, true, false, false, true, false}), 0.03);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1));
  for (std::uint32_t i = 0; i < 60; ++i) {
    const auto r = uniform4(7, Purpose::fill, i), v = uniform4(7, Purpose::fill, i, 1);
    const double y = 0.0125 * static_cast<double>(i / 4 % 4) + 0.001 * r[1] + shift;
    run.add({0.0125 * (static_cast<double>(i % 4) - 1.5) + 0.001 * r[0], y - 0.05 * std::floor(y / 0.05),
             0.006 + 0.0115 * static_cast<double>(i / 16) + 0.001 * r[2]},
            Eigen::Vector3d(v[0] - 0.5, v[1] - 0.5, v[2] - 1));
  }
  return run;
}

TEST(PeriodicWorld, a_cloud_shifted_by_half_a_period_does_the_same) {
  SceneRun one = rain("smooth", 0), two = rain("smooth", 0.025);
  one.run_until("raining", 0.1);
  two.run_until("raining", 0.1);
  std::map<std::uint32_t, std::size_t> place;
  for (std::size_t i = 0; i < two.state.balls.size(); ++i) place[two.state.balls.id[i]] = i;
  ASSERT_EQ(one.state.balls.size(), 60u);
  ASSERT_EQ(two.state.balls.size(), 60u);
  for (std::size_t i = 0; i < one.state.balls.size(); ++i) {
    const std::size_t k = place.at(one.state.balls.id[i]);
    Eigen::Vector3d apart = two.state.balls.position[k] - one.state.balls.position[i] - Eigen::Vector3d(0, 0.025, 0);
    apart[1] -= 0.05 * std::round(apart[1] / 0.05);
    EXPECT_LT(apart.norm(), 1e-6) << "ball " << one.state.balls.id[i];
  }
}

TEST(PeriodicWorld, a_collision_across_the_boundary_is_that_inside_and_conserves_momentum) {
  for (const char* method : {"nonsmooth", "smooth"}) {
    std::map<double, std::array<Eigen::Vector3d, 2>> after;
    for (const double y : {0.025, 0.0}) {
      Physics p;
      p.step.method = method;
      p.material.restitution = 0.6;
      p.effects.rolling_friction = 0.1;
      World world(p, 0.5);
      world.gravity_vector.setZero();
      world.set_period(0.05);
      SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1));
      run.add({0, y - 0.007, 0}, {0, 0.3, 0.05});
      run.add({0.004, y + 0.007, 0}, {0, -0.2, 0});
      run.run_until("flying", 0.1);
      std::array<Eigen::Vector3d, 2> v;
      for (std::size_t i = 0; i < 2; ++i) v[run.state.balls.id[i]] = run.state.balls.velocity[i];
      EXPECT_LT((v[0] + v[1] - Eigen::Vector3d(0, 0.1, 0.05)).norm(), 1e-6);
      EXPECT_LT(v[0][1], 0.1) << "they have not met";
      after[y] = v;
    }
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((after[0.025][i] - after[0.0][i]).norm(), 1e-5) << method;
  }
}

// --- what is read off

TEST(SliceField, finds_angle_distance_profile_and_zero_of_a_made_up_bed) {
  const double radius = 0.2, d = 0.01, angle = 30 * std::numbers::pi / 180, top = -0.05, zero = -0.12;
  SliceField field(radius, d, 1.0);
  // A lattice much finer than a ball, its volume spread evenly with a solid fraction of 0.6.
  const double step = 0.001, c = std::cos(angle), s = std::sin(angle);
  for (double x = -radius; x < radius; x += step)
    for (double z = -radius; z < radius; z += step) {
      const double y = x * s + z * c;
      if (x * x + z * z > radius * radius || y > top) continue;
      const double u = 5 * (y - zero);
      field.add(x, z, u * c, -u * s, 0.6 * step * step);
    }
  field.end_frame();
  const SliceField::Line line = field.surface_line();
  EXPECT_NEAR(line.angle, angle, 0.005);
  EXPECT_NEAR(line.distance, top, 0.1 * d);
  EXPECT_NEAR(field.mass_centre_angle(), angle, 0.005);
  const auto bins = field.profile(line.angle);
  const double surface = SliceField::surface_position(bins);
  EXPECT_NEAR(surface, top, 0.1 * d);
  EXPECT_NEAR(SliceField::zero_position(bins), zero, 0.1 * d);
  EXPECT_NEAR(SliceField::velocity_at(bins, -0.1), 5 * (-0.1 - zero), 0.01);
  for (const auto& bin : bins) {
    if (bin.y < top - d && bin.y > -radius + d) {
      EXPECT_NEAR(bin.fraction, 0.6, 0.04) << bin.y;
    }
  }
}

TEST(SliceField, of_nothing_says_that_there_is_nothing) {
  SliceField field(0.1, 0.01, 0.05);
  field.end_frame();
  EXPECT_LT(field.surface_line().points, 3u);
  const auto bins = field.profile(0.5);
  EXPECT_TRUE(std::isnan(SliceField::surface_position(bins)));
  EXPECT_TRUE(std::isnan(SliceField::zero_position(bins)));
  EXPECT_TRUE(std::isnan(SliceField::velocity_at(bins, 0)));
}

// --- the scene

RotatingDrumScene small_slice() {
  RotatingDrumScene scene;
  scene.diameter_m = 0.12;
  scene.length_m = 0.043;
  scene.angular_velocity_rad_s = 3.0;
  scene.fill = 0.3;
  scene.texture = {4000, 0.002, 0.004, 0.003, 0.005, "sigma"};
  scene.settle_turns = 0.3;
  scene.record_turns = 0.4;
  return scene;
}

TEST(RotatingDrum, carries_its_bed_to_a_slope_that_flows_down_while_the_wall_takes_it_up) {
  for (const char* method : {"nonsmooth", "smooth"}) {
    Physics p;
    p.step.method = method;
    if (p.step.method == "smooth") p.solver.outer_step_s = 0.002;
    RotatingDrumScene scene = small_slice();
    if (p.step.method == "smooth") scene.settle_turns = scene.record_turns = 0.15;
    const SceneResult r = scene.run(p, {});
    EXPECT_EQ(r.lost, 0);
    EXPECT_GT(value(r, "charge_angle"), 10);
    EXPECT_LT(value(r, "charge_angle"), 60);
    EXPECT_NEAR(value(r, "charge_angle"), value(r, "mass_centre_angle"), 12);
    EXPECT_GT(value(r, "surface_velocity"), 0);
    EXPECT_LT(value(r, "surface_position"), 0);
    EXPECT_LT(value(r, "zero_velocity_position"), value(r, "surface_position"));
    EXPECT_GT(value(r, "zero_velocity_position"), -0.06);
    EXPECT_GT(value(r, "coordination_number"), 2);
    EXPECT_NEAR(value(r, "axial_velocity"), 0, 0.02);
    // The lowest bin moves up-slope with the wall.
    for (const Observable& o : r.observables)
      if (o.name == "velocity_profile") {
        EXPECT_LT(o.value, 0);
        EXPECT_GT(o.value, -1.1 * 3.0 * 0.06);
        break;
      }
  }
}

TEST(RotatingDrum, is_a_function_of_its_file_and_seed) {
  RotatingDrumScene scene = small_slice();
  scene.settle_turns = 0.02;
  scene.record_turns = 0.05;
  Physics p;
  const SceneResult a = scene.run(p, {}), b = scene.run(p, {});
  EXPECT_EQ(state_hash(a.state), state_hash(b.state));
  EXPECT_EQ(observables_csv(a.observables), observables_csv(b.observables));
  p.seed = 2;
  EXPECT_NE(state_hash(scene.run(p, {}).state), state_hash(a.state));
}

TEST(RotatingDrum, coating_and_texture_height_act) {
  RotatingDrumScene scene = small_slice();
  scene.settle_turns = 0.1;
  scene.record_turns = 0.02;
  const auto lowest = [&](const Physics& p) {
    const SceneResult r = scene.run(p, {});
    double most = 0;
    for (const Eigen::Vector3d& at : r.state.balls.position) most = std::max(most, std::hypot(at[0], at[2]));
    EXPECT_EQ(r.lost, 0);
    return most;
  };
  Physics plain, coated, flat;
  coated.effects.drum_coating_m = 0.008;
  flat.effects.texture_height_scale = 0;
  const double with = lowest(plain);
  EXPECT_LT(lowest(coated), with - 0.004);
  EXPECT_GT(lowest(flat), with);
  EXPECT_NEAR(lowest(flat), 0.06 - 0.005, 0.001);
}

TEST(RotatingDrum, fed_at_one_end_loses_balls_over_the_other_and_none_elsewhere) {
  RotatingDrumScene scene = small_slice();
  scene.ends = "open_fed";
  scene.inclination_deg = 10;
  scene.length_m = 0.1;
  scene.fill = 0.1;
  scene.feed_kg_s = 0.1;
  scene.settle_turns = 0.5;
  scene.record_turns = 1;
  const SceneResult r = scene.run(Physics{}, {});
  const auto inside = static_cast<std::int64_t>(r.state.balls.size());
  EXPECT_EQ(r.lost, 0);
  EXPECT_GT(r.num_balls - inside, 20);
  EXPECT_NEAR(value(r, "feed_rate"), 0.1, 0.002);
  EXPECT_GT(value(r, "axial_velocity"), 0.01);
  EXPECT_GT(value(r, "residence_time"), 0.1);
  EXPECT_GT(value(r, "outflow_over_feed"), 0.2);
  for (const Eigen::Vector3d& at : r.state.balls.position) EXPECT_LT(at[1], 0.115);
}

TEST(RotatingDrum, keeps_its_balls_between_end_walls) {
  RotatingDrumScene scene = small_slice();
  scene.ends = "walls";
  scene.settle_turns = 0.1;
  scene.record_turns = 0.1;
  const SceneResult r = scene.run(Physics{}, {});
  EXPECT_EQ(r.lost, 0);
  for (const Eigen::Vector3d& at : r.state.balls.position) {
    EXPECT_GT(at[1], 0.0045);
    EXPECT_LT(at[1], 0.043 - 0.0045);
  }
}

TEST(RotatingDrum, refuses_what_it_cannot_do_naming_the_key) {
  const auto refused = [](const std::string& scene, const std::string& effects, const std::string& key) {
    const std::string text = "[scene]\ntype = \"drum\"\n" + scene + "\n[effects]\n" + effects + "\n";
    EXPECT_NE(scene_error(text).find(key), std::string::npos) << text << scene_error(text);
  };
  EXPECT_NO_THROW(parse_scene("[scene]\ntype = \"drum\"\nfill = 0.3\n", "x.toml"));
  refused("fill = 0.3", "outlet_coating_m = 0.01", "outlet_coating_m");
  refused("fill = 0.3", "texture_height_scale = 2.0", "texture_height_scale");  // no texture
  refused("", "", "scene.fill");
  refused("fill = 0.3\nnum_balls = 10", "", "scene.num_balls");
  refused("fill = 0.3\nlength_m = 0.02", "", "scene.length_m");
  refused("fill = 0.3\nangular_velocity_rad_s = 9.0", "", "scene.angular_velocity_rad_s");
  refused("fill = 0.3\nfeed_kg_s = 1.0", "", "scene.feed_kg_s");
  refused("ends = \"open_fed\"", "", "scene.feed_kg_s");
  refused("ends = \"open\"\nfill = 0.3", "", "periodic | walls | open_fed");
  RotatingDrumScene full = small_slice();
  full.fill = 0.5;
  full.fill_packing = 0.74;
  EXPECT_THROW(full.run(Physics{}, {}), InputError);
}

}  // namespace
}  // namespace drumsweep
