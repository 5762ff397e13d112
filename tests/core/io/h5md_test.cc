/// Walks stored states with the HDF5 library alone and holds them against the text of H5MD 1.1.0 and of its units module
/// 1.0.0 (https://www.nongnu.org/h5md/).
#include "core/io/h5md.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <map>
#include <regex>
#include <set>

#include "core/io/snapshot.h"
#include "support/open_image.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

/// A state of three balls, one of them out of a slot, at step 20.
WarmState three_balls() {
  WarmState warm;
  for (std::uint32_t i = 0; i < 3; ++i) warm.state.balls.add({0.1 * i, 0.2, 0.3}, 0.005, 7 - i);
  warm.state.balls.exit[1] = 2;
  warm.state.num_steps = 20;
  warm.finished = true;
  return warm;
}

/// Type class and shape of an attribute or dataset, and its text where it is one.
struct Seen {
  H5T_class_t type = H5T_NO_CLASS;
  bool variable_length = false, ascii = false;
  std::vector<hsize_t> shape;
  std::string text;
  std::vector<std::int64_t> numbers;
};

void look_at_type(hid_t type, hid_t space, Seen& seen) {
  seen.type = H5Tget_class(type);
  seen.variable_length = seen.type == H5T_STRING && H5Tis_variable_str(type) > 0;
  seen.ascii = seen.type == H5T_STRING && H5Tget_cset(type) == H5T_CSET_ASCII;
  seen.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  if (!seen.shape.empty()) H5Sget_simple_extent_dims(space, seen.shape.data(), nullptr);
}

Seen attribute(hid_t file, const std::string& object, const std::string& name) {
  Seen seen;
  const hid_t attr = H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  if (attr < 0) return seen;
  const hid_t type = H5Aget_type(attr), space = H5Aget_space(attr);
  look_at_type(type, space, seen);
  if (seen.type == H5T_STRING && !seen.variable_length) {
    const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    seen.text.resize(count * H5Tget_size(type));
    H5Aread(attr, type, seen.text.data());
  }
  if (seen.type == H5T_INTEGER) {
    seen.numbers.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Aread(attr, H5T_NATIVE_INT64, seen.numbers.data());
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(attr);
  return seen;
}

Seen dataset(hid_t file, const std::string& name) {
  Seen seen;
  const hid_t data = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  if (data < 0) return seen;
  const hid_t type = H5Dget_type(data), space = H5Dget_space(data);
  look_at_type(type, space, seen);
  if (seen.type == H5T_INTEGER) {
    seen.numbers.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(data, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, seen.numbers.data());
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(data);
  return seen;
}

std::vector<std::string> members(hid_t file, const std::string& group) {
  std::vector<std::string> names;
  hsize_t at = 0;
  H5Literate_by_name(
      file, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, &at,
      [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
      },
      &names, H5P_DEFAULT);
  return names;
}

haddr_t address(hid_t file, const std::string& name) {
  H5O_info_t info;
  return H5Oget_info_by_name(file, name.c_str(), &info, H5P_DEFAULT) < 0 ? HADDR_UNDEF : info.addr;
}

using Shape = std::vector<hsize_t>;

TEST(H5md, metadata_are_as_the_specification_wants_them) {
  const OpenImage image(pack_warm_state(small_drum(), three_balls()));
  ASSERT_GE(image.file, 0);
  const Seen version = attribute(image.file, "/h5md", "version");
  EXPECT_EQ(version.shape, Shape{2});
  EXPECT_EQ(version.numbers, (std::vector<std::int64_t>{1, 1}));
  for (const auto& [object, name] :
       {std::pair("/h5md/author", "name"), std::pair("/h5md/creator", "name"), std::pair("/h5md/creator", "version"),
        std::pair("/h5md/modules/units", "system")}) {
    const Seen text = attribute(image.file, object, name);
    EXPECT_EQ(text.type, H5T_STRING) << object;
    EXPECT_FALSE(text.variable_length) << object;
    EXPECT_TRUE(text.shape.empty()) << object;
    EXPECT_FALSE(text.text.empty()) << object;
  }
  EXPECT_EQ(attribute(image.file, "/h5md/modules/units", "version").numbers, (std::vector<std::int64_t>{1, 0}));
  EXPECT_EQ(attribute(image.file, "/h5md/modules/units", "system").text, "SI");
  const std::set<std::string> root = {"h5md", "particles", "drumsweep"};
  for (const std::string& name : members(image.file, "/")) EXPECT_EQ(root.count(name), 1u) << name;
}

TEST(H5md, elements_of_the_particles_have_one_frame_and_share_step_and_time) {
  const OpenImage image(pack_warm_state(small_drum(), three_balls()));
  const std::string group = "/particles/balls/";
  const std::map<std::string, std::pair<H5T_class_t, Shape>> expected = {
      {"position", {H5T_FLOAT, {1, 3, 3}}}, {"velocity", {H5T_FLOAT, {1, 3, 3}}}, {"mass", {H5T_FLOAT, {1, 3}}},
      {"species", {H5T_INTEGER, {1, 3}}},   {"id", {H5T_INTEGER, {1, 3}}},        {"spin", {H5T_FLOAT, {1, 3, 3}}},
      {"radius", {H5T_FLOAT, {1, 3}}},      {"exit", {H5T_INTEGER, {1, 3}}}};
  // Units: factors apart by a blank, a number or a symbol with a power that is not zero; ASCII of fixed length.
  const std::regex unit("(\\d+|(m|s|kg|rad)([+-]?[1-9])?)( (m|s|kg|rad)([+-]?[1-9])?)*");
  std::size_t found = 0;
  for (const std::string& name : members(image.file, group)) {
    if (name == "box") continue;
    ASSERT_EQ(expected.count(name), 1u) << name;
    ++found;
    const Seen value = dataset(image.file, group + name + "/value");
    EXPECT_EQ(value.type, expected.at(name).first) << name;
    EXPECT_EQ(value.shape, expected.at(name).second) << name;
    const Seen text = attribute(image.file, group + name + "/value", "unit");
    EXPECT_TRUE(std::regex_match(text.text, unit)) << name << ": " << text.text;
    EXPECT_TRUE(text.ascii && !text.variable_length && text.shape.empty()) << name;
    for (const char* axis : {"/step", "/time"})
      EXPECT_EQ(address(image.file, group + name + axis), address(image.file, group + "position" + axis)) << name;
  }
  EXPECT_EQ(found, expected.size());
  const Seen step = dataset(image.file, group + "position/step"), time = dataset(image.file, group + "position/time");
  EXPECT_EQ(step.shape, Shape{1});
  EXPECT_EQ(step.numbers, std::vector<std::int64_t>{20});
  EXPECT_EQ(time.type, H5T_FLOAT);
  EXPECT_EQ(time.shape, Shape{1});
  EXPECT_EQ(attribute(image.file, group + "position/time", "unit").text, "s");
  EXPECT_EQ(dataset(image.file, group + "id/value").numbers, (std::vector<std::int64_t>{7, 6, 5}));
}

TEST(H5md, the_box_has_three_dimensions_without_boundary) {
  const OpenImage image(pack_warm_state(small_drum(), three_balls()));
  const Seen dimension = attribute(image.file, "/particles/balls/box", "dimension");
  EXPECT_TRUE(dimension.shape.empty());
  EXPECT_EQ(dimension.numbers, std::vector<std::int64_t>{3});
  const Seen boundary = attribute(image.file, "/particles/balls/box", "boundary");
  EXPECT_EQ(boundary.shape, Shape{3});
  EXPECT_FALSE(boundary.variable_length);
  EXPECT_EQ(boundary.text, std::string("none\0none\0none\0", 15));
}

}  // namespace
}  // namespace drumsweep
