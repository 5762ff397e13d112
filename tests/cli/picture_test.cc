/// picture and export, by the real program.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "cli/program.h"

namespace drumsweep {
namespace {

/// Whether a program can be started; with a word on standard output where not.
bool is_there(const std::string& program) {
  const char* list = std::getenv("PATH");
  std::istringstream folders(list != nullptr ? list : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  return false;
}

/// A finished sweep over two designs, made once.
const TestFolder& sweep_folder() {
  static const TestFolder folder;
  if (!std::filesystem::exists(folder / "out")) {
    write_text(folder / "study.toml",
               replaced(tiny_study(1), "from = 0.02, to = 0.03, count = 2", "from = 0.03, to = 0.5, count = 2"));
    EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 4);  // 0.5 m is no possible slot
  }
  return folder;
}

void expect_refused(const std::vector<std::string>& words, const std::string& must_name) {
  const Finished result = drumsweep(sweep_folder(), words);
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_NE(result.err.find(must_name), std::string::npos) << must_name << " is not in: " << result.err;
}

TEST(PictureAndExport, wrong_input_is_refused_with_what_is_expected) {
  expect_refused({"picture", "nowhere.h5", "-o", "p.png"}, "nowhere.h5");
  expect_refused({"picture", "out/warm_state.h5", "-o", "p.jpg"}, "p.jpg");
  expect_refused({"picture", "out/warm_state.h5", "-o", "p.png", "--size", "640"}, "--size 640");
  expect_refused({"picture", "out/warm_state.h5", "-o", "p.avi", "--animate"}, "p.avi");
  expect_refused({"picture", "out/warm_state.h5", "-o", "p.png", "--id", "abc"}, "--id");
  expect_refused({"export", "out", "--at", "1,0.5", "--format", "stl", "-o", "e"}, "no such drum");
  expect_refused({"export", "out", "--at", "1,0.031", "--format", "stl", "-o", "e"}, "nearest");
  expect_refused({"export", "out", "--format", "vtkhdf", "--frames", "3", "-o", "e"}, "--frames 3");
  expect_refused({"export", "out", "--format", "ply", "-o", "e"}, "ply");
  expect_refused({"export", "tmp", "--format", "stl", "-o", "e"}, "tmp");
  for (const auto& entry : std::filesystem::directory_iterator(sweep_folder() / "out/designs"))
    if (entry.path().extension() == ".h5")
      expect_refused({"picture", entry.path().string(), "-o", "p.png"}, "warm_state.h5");
  EXPECT_FALSE(std::filesystem::exists(sweep_folder() / "e"));
  EXPECT_FALSE(std::filesystem::exists(sweep_folder() / "p.png"));
  for (const char* command : {"picture", "export"}) {
    const Finished help = drumsweep(sweep_folder(), {command, "--help"});
    EXPECT_NE(help.out.find(std::string("drumsweep ") + command), std::string::npos) << help.out;
  }
}

TEST(PictureAndExport, every_format_writes_its_files) {
  const TestFolder& folder = sweep_folder();
  const auto expect_files = [&](const std::vector<std::string>& more, const std::vector<std::string>& names) {
    std::vector<std::string> words = {"export", "out", "-o", "files"};
    words.insert(words.end(), more.begin(), more.end());
    const Finished result = drumsweep(folder, words);
    ASSERT_EQ(result.code, 0) << result.err;
    for (const std::string& name : names) {
      EXPECT_GT(std::filesystem::file_size(folder / ("files/" + name)), 80u) << name;
      EXPECT_NE(result.out.find(name), std::string::npos) << result.out;
    }
  };
  expect_files({"--format", "xdmf", "--lead", "0.1"},
               {"balls.h5", "balls.xmf", "drum.xmf", "belt.xmf", "landings.xmf", "open_in_paraview.py"});
  expect_files({"--format", "vtkhdf", "--lead", "0", "--at", "3,0.03"}, {"balls.hdf", "drum.hdf", "landings.hdf"});
  expect_files({"--format", "stl"}, {"drum.stl", "belt.stl"});
  expect_files({"--format", "obj"}, {"drum.obj", "belt.obj"});
}

TEST(PictureAndExport, a_scene_can_be_exported_but_not_continued) {
  const TestFolder folder;
  ASSERT_EQ(drumsweep(folder, {"init", "--preset", "scenes", "s"}).code, 0);
  ASSERT_EQ(drumsweep(folder, {"simulate", "s/drop.toml", "-o", "out"}).code, 0);
  const Finished good = drumsweep(folder, {"export", "out/drop.h5", "--format", "xdmf", "-o", "view"});
  ASSERT_EQ(good.code, 0) << good.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "view/wall.xmf"));
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--frames", "3"}, {"--lead", "1"}}) {
    std::vector<std::string> words = {"export", "out/drop.h5", "--format", "xdmf", "-o", "other"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(drumsweep(folder, words).code, 2);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
}

TEST(PictureAndExport, renders_a_picture_and_a_film_and_cleans_up_after_ctrl_c) {
  if (!is_there("povray")) GTEST_SKIP() << "povray is not installed";
  const TestFolder& folder = sweep_folder();
  const Finished still = drumsweep(folder, {"picture", "out/warm_state.h5", "-o", "p.png", "--size", "200x160"});
  ASSERT_EQ(still.code, 0) << still.err;
  EXPECT_EQ(file_text(folder / "p.png").substr(1, 3), "PNG");
  if (!is_there("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const Finished film = drumsweep(folder, {"picture", "out", "-o", "f.gif", "--animate", "--frames", "3", "--seconds",
                                           "0.1", "--lead", "0.2", "--size", "200x160", "--colour", "slot"});
  ASSERT_EQ(film.code, 0) << film.err;
  EXPECT_EQ(file_text(folder / "f.gif").substr(0, 3), "GIF");

  Program stopped(folder, {DRUMSWEEP_BINARY, "picture", "out", "-o", "s.gif", "--animate", "--frames", "500", "--lead",
                           "0", "--size", "200x160"});
  const auto scratch = [&] { return count_files(folder / "tmp", "") > 0; };
  ASSERT_TRUE(wait_until(scratch));
  stopped.signal(SIGINT);
  EXPECT_EQ(stopped.wait(), 3) << stopped.err();
  EXPECT_FALSE(std::filesystem::exists(folder / "s.gif"));
  EXPECT_FALSE(scratch());
}

TEST(PictureAndExport, paraview_opens_what_was_exported) {
  if (!is_there("pvpython"))
    GTEST_SKIP() << "pvpython is not installed; what other programs see is tested by reading back";
  const TestFolder& folder = sweep_folder();
  ASSERT_EQ(drumsweep(folder, {"export", "out", "--format", "xdmf", "-o", "series", "--frames", "3", "--seconds", "0.2",
                               "--lead", "0.5"})
                .code,
            0);
  ASSERT_EQ(drumsweep(folder, {"export", "out/warm_state.h5", "--format", "vtkhdf", "-o", "moment"}).code, 0);
  ASSERT_EQ(drumsweep(folder, {"export", "out/warm_state.h5", "--format", "stl", "-o", "moment"}).code, 0);
  write_text(folder / "look.py", R"py(
from paraview.simple import *
balls = XDMFReader(FileNames=['series/balls.xmf'])
print('times', len(balls.TimestepValues))
for t in balls.TimestepValues:
    balls.UpdatePipeline(t)
    info = balls.GetDataInformation()
    print('balls', info.GetNumberOfPoints(), info.GetNumberOfCells(), round(balls.PointData['diameter_m'].GetRange()[0], 6))
    print(' '.join(sorted(balls.PointData.keys())))
drum = XDMFReader(FileNames=['series/drum.xmf'])
drum.UpdatePipeline(drum.TimestepValues[-1])
hdf = OpenDataFile('moment/drum.hdf')
hdf.UpdatePipeline()
stl = OpenDataFile('moment/drum.stl')
stl.UpdatePipeline()
same = {r.GetDataInformation().GetNumberOfCells() for r in (drum, hdf, stl)}
print('walls', len(same), same.pop() > 100)
landings = XDMFReader(FileNames=['series/landings.xmf'])
landings.UpdatePipeline(landings.TimestepValues[-1])
print('landings', landings.GetDataInformation().GetNumberOfPoints() > 10)
)py");
  Program look(folder, {"pvpython", "look.py"});
  ASSERT_EQ(look.wait(), 0) << look.err();
  EXPECT_EQ(look.err(), "");
  const std::string out = look.out();
  for (const char* word :
       {"times 3", " 0.01\n", "diameter_m id slot speed_m_s spin_rad_s velocity_m_s", "walls 1 True", "landings True"})
    EXPECT_NE(out.find(word), std::string::npos) << word << " is not in: " << out;
}

}  // namespace
}  // namespace drumsweep
