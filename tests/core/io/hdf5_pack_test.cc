#include "core/io/hdf5_pack.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct PackTest : testing::Test {
  std::string path = testing::TempDir() + "pack_" + std::to_string(::getpid()) + ".h5";
  void TearDown() override { std::filesystem::remove(path); }

  static std::string image(double first) {
    Hdf5Writer file;
    const std::vector<double> x{first, 2, 3, 4, 5, 6};
    file.dataset("group/x", x, 3, "m", "places");
    file.texts("names", {"one", "two α"}, "two words");
    file.attribute("text", std::string("said"));
    file.attribute("number", first);
    return file.seal("sample", 3);
  }
  static std::vector<std::pair<std::string, std::string>> images() {
    return {{"a", image(1)}, {"b", image(10)}, {"c", image(100)}};
  }
};

TEST_F(PackTest, every_image_comes_back_from_its_group) {
  write_durably(path, make_pack(images()));
  verify_pack(path);
  const auto index = read_pack_index(path);
  ASSERT_EQ(index.size(), 3u);
  EXPECT_EQ(index[1].name, "b");
  const Seal seal = verify_seal(image(10), "b");
  EXPECT_EQ(index[1].crc, seal.crc);
  EXPECT_EQ(index[1].bytes, seal.bytes);
  const Hdf5Reader file(path, "b");
  EXPECT_EQ(file.doubles("group/x"), (std::vector<double>{10, 2, 3, 4, 5, 6}));
  EXPECT_EQ(file.texts("names"), (std::vector<std::string>{"one", "two α"}));
  EXPECT_EQ(file.text("text"), "said");
  EXPECT_THROW(Hdf5Reader(path, "d"), StoreError);
}

TEST_F(PackTest, standard_tools_open_it) {
  if (std::system("h5dump --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "h5dump (hdf5-tools) is not installed";
  write_durably(path, make_pack(images()));
  EXPECT_EQ(std::system(("h5dump -d /b/group/x " + path + " | grep -q '(0,0): 10, 2, 3'").c_str()), 0);
}

TEST_F(PackTest, a_flipped_bit_anywhere_is_found_and_never_gives_other_values) {
  const std::string whole = make_pack(images());
  std::size_t content = 0, still_good = 0;
  while (whole.compare(content, 4, "\211HDF") != 0) content += 512;
  for (std::size_t i = 0; i < whole.size(); i += 13) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 4);
    write_durably(path, flipped);
    // Padding behind the index holds nothing.
    if (i >= content) {
      EXPECT_THROW(verify_pack(path), StoreError) << i;
    }
    for (const auto& [name, first] : {std::pair("a", 1.0), std::pair("b", 10.0), std::pair("c", 100.0)}) {
      try {
        const Hdf5Reader file(path, name);
        EXPECT_EQ(file.doubles("group/x"), (std::vector<double>{first, 2, 3, 4, 5, 6})) << i;
        EXPECT_EQ(file.real("number"), first) << i;
        ++still_good;
      } catch (const StoreError&) {
      }
    }
  }
  // One flip hits one image at most, unless it hits what all of them share.
  EXPECT_GT(still_good, 3 * (whole.size() / 13) / 2);
}

TEST_F(PackTest, a_torn_file_and_one_of_something_else_are_refused) {
  const std::string whole = make_pack(images());
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    write_durably(path, whole.substr(0, size));
    EXPECT_THROW(verify_pack(path), StoreError) << size;
  }
  write_durably(path, image(1));
  EXPECT_THROW(read_pack_index(path), StoreError);
  std::string damaged = image(1);
  damaged[700] ^= 1;
  EXPECT_THROW(make_pack({{"a", damaged}}), StoreError);
}

}  // namespace
}  // namespace drumsweep
