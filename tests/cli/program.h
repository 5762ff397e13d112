/// Runs the real program as a user would, and looks at what it leaves.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace drumsweep {

/// A folder of its own, with its own TMPDIR (many kills leave Open MPI's session folders behind), gone after the test.
struct TestFolder {
  std::string path;
  TestFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "drumsweep-test-XXXXXX").string();
    path = ::mkdtemp(pattern.data());
    std::filesystem::create_directory(path + "/tmp");
  }
  ~TestFolder() {
    // Ranks that were just killed may still be tidying up in there.
    std::error_code error;
    for (int i = 0; i < 100 && std::filesystem::exists(path, error); ++i) {
      std::filesystem::remove_all(path, error);
      if (error) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

inline std::string file_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// A process that was started, with its output in files.
class Program {
 public:
  /// Runs `words` in the folder; words[0] is looked up in PATH.
  Program(const TestFolder& folder, std::vector<std::string> words) : out_(folder / "stdout"), err_(folder / "stderr") {
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that is killed leaves nothing running
    const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int err = ::open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    if (::chdir(folder.path.c_str()) != 0) ::_exit(126);
    ::setenv("TMPDIR", (folder / "tmp").c_str(), 1);
    // Threads that spin for each other on a busy machine multiply the time of a warm-up.
    ::setenv("OMP_WAIT_POLICY", "passive", 1);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execvp(pointers[0], pointers.data());
    ::_exit(127);
  }
  ~Program() {
    if (code_ < 0) kill_all();
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Exit code, 128 + signal when it was killed. Whoever takes two minutes hangs: he is killed and the test fails.
  int wait() {
    for (int i = 0; code_ < 0; ++i) {
      int status = 0;
      if (::waitpid(pid_, &status, WNOHANG) == pid_)
        code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      else if (i > 100000) {
        ADD_FAILURE() << "the program hangs; standard error:\n" << err();
        kill_all();
      } else
        sleep_ms(5);
    }
    return code_;
  }
  bool running() {
    int status = 0;
    if (code_ < 0 && ::waitpid(pid_, &status, WNOHANG) == pid_)
      code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return code_ < 0;
  }
  void signal(int number) const { ::kill(pid_, number); }
  pid_t pid() const { return pid_; }

  /// kill -9 of it and of its children (the ranks under mpirun), at once.
  void kill_all() {
    const std::string children =
        file_text("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) + "/children");
    ::kill(pid_, SIGKILL);
    std::istringstream list(children);
    for (pid_t child = 0; list >> child;) ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(pid_, &status, 0);
    code_ = 128 + SIGKILL;
  }
  std::string out() const { return file_text(out_); }
  std::string err() const { return file_text(err_); }

 private:
  pid_t pid_ = -1;
  int code_ = -1;
  std::string out_, err_;
};

/// What a finished program gave.
struct Finished {
  int code;
  std::string out, err;
};

inline Finished drumsweep(const TestFolder& folder, const std::vector<std::string>& arguments) {
  // Not insert(begin(), ...), of which GCC 12 warns falsely where the path is long.
  std::vector<std::string> words = {DRUMSWEEP_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  Program program(folder, std::move(words));
  const int code = program.wait();
  return {code, program.out(), program.err()};
}

inline std::vector<std::string> under_mpirun(int ranks, std::vector<std::string> arguments) {
  std::vector<std::string> words = {"mpirun", "-q", "--oversubscribe", "-n", std::to_string(ranks), DRUMSWEEP_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

/// Waits until something has happened; false after half a minute.
inline bool wait_until(const std::function<bool()>& happened) {
  for (int i = 0; i < 6000; ++i) {
    if (happened()) return true;
    sleep_ms(5);
  }
  return false;
}

/// A drum of 0.2 m with about 110 balls in it: a tenth of a second of CPU per design and two recorded turns.
inline std::string tiny_study(int turns = 2, int nodes = 2, const std::string& more = "") {
  return R"(name = "tiny"
seed = 7
[drum]
diameter_m = 0.2
length_m = 0.2
angular_velocity_rad_s = 4.8
mesh_resolution_m = 0.02
texture.density_1_m2 = 0
[outlet]
length_m = 0.15
opening_angle_deg = 2.0
base_width_m = 0.03
[belt]
width_m = 0.3
outlet_begin_m = 0.05
[feed]
rate_kg_s = 0.15
zone_begin_m = 0.02
zone_length_m = 0.08
zone_width_m = 0.08
[solver]
outer_step_s = 0.005
sub_steps = 1
iterations = 10
[warmup]
window_turns = 2
max_turns = 12
tolerance = 0.2
windows = 1
[record]
adapt_turns = 1
turns = )" +
         std::to_string(turns) +
         R"(
[[stage]]
name = "coarse"
variables = [
  { key = "outlet.opening_angle_deg", from = 1, to = 3, count = )" +
         std::to_string(nodes) + R"( },
  { key = "outlet.base_width_m", from = 0.02, to = 0.03, count = )" +
         std::to_string(nodes) + " },\n]\n" + more;
}

inline std::size_t count_files(const std::string& folder, const std::string& ending) {
  std::size_t number = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().string().ends_with(ending)) ++number;
  return number;
}

/// The text with `from` replaced, which must be in it once.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace drumsweep
