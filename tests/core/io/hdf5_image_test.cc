#include "core/io/hdf5_image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

std::string sample() {
  Hdf5Writer file;
  const std::vector<double> x{1, 2, 3, 4, 5, 6};
  const std::vector<std::uint8_t> none;
  file.dataset("group/x", x, 3, "m", "places");
  file.dataset("none", none, 1, "1", "empty");
  file.attribute("text", std::string("with unicode: α"));
  file.attribute("empty", std::string());
  file.attribute("pi", 3.25);
  file.attribute("count", std::int64_t{-7});
  return file.seal("sample", 3);
}

TEST(Hdf5Image, gives_back_what_was_put_in) {
  const Hdf5Reader file(sample(), "sample", 3, "it");
  EXPECT_EQ(file.doubles("group/x"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(file.uint8s("none").empty());
  EXPECT_EQ(file.text("text"), "with unicode: α");
  EXPECT_EQ(file.text("empty"), "");
  EXPECT_EQ(file.real("pi"), 3.25);
  EXPECT_EQ(file.integer("count"), -7);
}

TEST(Hdf5Image, equal_content_gives_equal_bytes_at_any_time) {
  const std::string now = sample();
  ::sleep(1);  // HDF5 keeps times in whole seconds
  EXPECT_TRUE(sample() == now);
}

TEST(Hdf5Image, every_truncation_and_bit_flip_is_refused) {
  const std::string whole = sample();
  for (std::size_t size = 0; size < whole.size(); size += 37)
    EXPECT_THROW(Hdf5Reader(whole.substr(0, size), "sample", 3, "it"), StoreError) << size;
  EXPECT_THROW(Hdf5Reader(whole + "x", "sample", 3, "it"), StoreError);
  for (std::size_t i = 512; i < whole.size(); i += 11) {
    std::string bad = whole;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    EXPECT_THROW(Hdf5Reader(bad, "sample", 3, "it"), StoreError) << i;
  }
}

TEST(Hdf5Image, another_kind_layout_or_program_is_named) {
  const auto message = [](const std::string& bytes, const char* kind, int layout) -> std::string {
    try {
      Hdf5Reader(bytes, kind, layout, "it");
    } catch (const StoreError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(sample(), "other", 3).find("holds a sample, not a other"), std::string::npos);
  EXPECT_NE(message(sample(), "sample", 4).find("layout 3"), std::string::npos);
  EXPECT_NE(message("\211HDF\r\n", "sample", 3).find("not a drumsweep file"), std::string::npos);
}

TEST(Hdf5Image, standard_tools_open_the_file) {
  if (std::system("h5dump --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "h5dump (hdf5-tools) is not installed";
  const std::string path = testing::TempDir() + "image_" + std::to_string(::getpid()) + ".h5";
  write_durably(path, sample());
  EXPECT_EQ(std::system(("h5dump -d /group/x " + path + " | grep -q '(1,0): 4, 5, 6'").c_str()), 0);
  std::filesystem::remove(path);
}

TEST(DurableFile, a_failed_write_leaves_the_old_file_and_no_rubbish) {
  const std::string folder = testing::TempDir() + "durable_" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  write_durably(folder + "/a", "old");
  EXPECT_THROW(write_durably(folder + "/missing/a", "new"), WriteError);
  std::filesystem::create_directory(folder + "/b");
  EXPECT_THROW(write_durably(folder + "/b", "new"), WriteError);  // a folder is in the way
  EXPECT_EQ(read_whole_file(folder + "/a"), "old");
  write_durably(folder + "/a", "new");
  EXPECT_EQ(read_whole_file(folder + "/a"), "new");
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& e : std::filesystem::directory_iterator(folder)) ++entries;
  EXPECT_EQ(entries, 2u);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace drumsweep
