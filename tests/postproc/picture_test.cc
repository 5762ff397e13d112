#include "postproc/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/config/schema.h"
#include "postproc/animation.h"
#include "support/complaint.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

Still loaded_drum() {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState state = filled_drum(model, 120);
  for (std::size_t i = 0; i < state.balls.size(); ++i) {
    state.balls.velocity[i] = Eigen::Vector3d(0.01 * static_cast<double>(i), 0, 0);
    state.balls.exit[i] = static_cast<std::uint8_t>(i % 4 == 3 ? 255u : i % 4);
  }
  return still_of(model, state, model.belt_height);
}

Still a_scene() {
  StoredScene scene;
  scene.name = "two balls";
  scene.balls.add({0, 0, 0.005}, 0.005, 0);
  scene.balls.add({0.02, 0, 0.005}, 0.005, 1);
  // A ground that reaches far: it must not make the balls a speck.
  scene.walls.push_back({{{-50, -50, 0}, {50, -50, 0}, {0, 50, 0}}, {{0, 1, 2}}, {}});
  return still_of(std::move(scene));
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t num = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++num;
  return num;
}

TEST(Picture, shows_all_balls_with_colour_bar_scale_bar_and_caption) {
  const Still still = loaded_drum();
  for (const char* colour : {"speed", "height", "axial", "slot"}) {
    PictureOptions options;
    options.colour = colour;
    const PictureFrame frame = picture_frame(still, options);
    const std::string scene = pov_scene(still, options, frame, "my \"caption\"");
    EXPECT_EQ(count(scene, "sphere {"), still.balls.size()) << colour;
    EXPECT_NE(scene.find("my 'caption'"), std::string::npos);
    EXPECT_NE(scene.find(" m\""), std::string::npos) << "no unit at the scale bar";
    if (std::string(colour) == "slot") {
      EXPECT_EQ(count(scene, "Label(\"slot "), static_cast<std::size_t>(still.drum->num_slots));
    } else {
      EXPECT_NE(scene.find(frame.colour_label), std::string::npos);
    }
  }
}

TEST(Picture, the_frame_holds_the_drum_and_the_belt_and_its_axes_are_right_handed) {
  const Still still = loaded_drum();
  const PictureOptions options;
  const PictureFrame frame = picture_frame(still, options);
  EXPECT_NEAR((frame.right.cross(frame.up) + frame.into).norm(), 0, 1e-12);
  EXPECT_GT(frame.up[2], 0);
  EXPECT_NEAR(frame.high / frame.tick, std::round(frame.high / frame.tick), 1e-9);
  EXPECT_NEAR(frame.high, 1.2, 1e-9);  // all but the fastest 2 % of up to 1.19 m/s, rounded up
  for (const Eigen::Vector3d& p : still.walls.back().mesh.vertices) {
    const Eigen::Vector3d from_centre = (p - frame.centre) / frame.metres_per_pixel;
    EXPECT_LT(std::abs(from_centre.dot(frame.right)), 0.5 * options.width);
    EXPECT_LT(std::abs(from_centre.dot(frame.up)), 0.5 * options.height);
  }
}

TEST(Picture, of_a_scene_the_balls_fill_it_and_what_only_a_drum_has_is_refused) {
  const Still still = a_scene();
  PictureOptions options;
  const PictureFrame frame = picture_frame(still, options);
  EXPECT_LT(frame.metres_per_pixel * options.width, 0.1);
  options.colour = "slot";
  EXPECT_NE(complaint([&] { picture_frame(still, options); }).find("--colour slot"), std::string::npos);
  options = {};
  options.view = "outlet";
  EXPECT_NE(complaint([&] { picture_frame(still, options); }).find("--view outlet"), std::string::npos);
  EXPECT_NE(complaint([] {
              picture_frame(Still{"empty", 0, {}, {}, {}}, {});
            }).find("neither balls nor walls"),
            std::string::npos);
}

TEST(Picture, is_rendered_and_joined_to_a_film_where_the_programs_are_there) {
  PictureOptions options;
  options.width = 160;
  options.height = 120;
  const Still still = a_scene();
  try {
    need_povray();
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << error.what();
  }
  const std::string png = rendered(still, options, picture_frame(still, options), "t");
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_GT(png.size(), 1000u);
  try {
    need_program("ffmpeg", "");
  } catch (const std::runtime_error& error) {
    GTEST_SKIP() << error.what();
  }
  const ScratchFolder folder;
  const std::string path = (folder.path / "film.gif").string();
  Animation film(path, options);
  film.add(still, "one");
  film.add(still, "two");
  film.write(10);
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
}

TEST(Animation, another_ending_is_refused_before_anything_is_done) {
  EXPECT_THROW(Animation("film.avi", {}), InputError);
}

}  // namespace
}  // namespace drumsweep
