#include "sweep/doctor/doctor.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "sweep/doctor/folder_check.h"
#include "sweep/doctor/rank_facts.h"
#include "sweep/job_script.h"

namespace drumsweep {
namespace {

// Messages, all under Tag::check; the first line says what is asked:
//
//   0 -> r                                  r -> 0
//   facts                                   pack_facts()
//   ping                                    -
//   look, probe file, token, lock file      "seen" or "missing", "held" or "free"
//   end                                     no answer

using Level = Finding::Level;
using Clock = std::chrono::steady_clock;

constexpr double patience_s = 30;
/// A file that rank 0 has written must show up within this time on other nodes (network file systems cache folders).
constexpr double visibility_s = 10;
constexpr int num_pings = 100;
constexpr std::size_t most_partners = 64;  // of the round trips, each on another host
constexpr double slow_round_trip_us = 10000;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::string look(const std::string& probe, const std::string& token, const std::string& lock) {
  const auto seen = [&] {
    try {
      return read_whole_file(probe) == token;
    } catch (const std::exception&) {
      return false;
    }
  };
  const auto begin = Clock::now();
  while (!seen()) {
    if (seconds_since(begin) > visibility_s) return "missing\nfree\n";
    Farm::nap();
  }
  return read_held_lock(lock) ? "seen\nheld\n" : "seen\nfree\n";
}

class Examination {
 public:
  Examination(Farm& farm, const DoctorOptions& options) : farm_(farm), options_(options) {}

  DoctorReport run() {
    report_.ranks = farm_.size();
    if (ask_for_facts()) {
      add(judge_ranks(facts_, options_.threads));
      time_messages();
    }
    examine_folder();
    add(examine_surroundings(farm_.size() > 1));
    farm_.send_all(Tag::check, "end\n");
    // A rank that is stuck must not keep us in MPI_Finalize.
    if (silent_.empty()) farm_.close();
    return report_;
  }

 private:
  void add(std::vector<Finding> findings) {
    for (Finding& f : findings) report_.findings.push_back(std::move(f));
  }

  /// Asks ranks the same; their answers in order of arrival are put into `answers`. Who is silent is noted.
  std::map<int, std::string> ask(const std::vector<int>& ranks, const std::string& question) {
    for (const int rank : ranks) farm_.send(rank, Tag::check, question);
    std::map<int, std::string> answers;
    const auto begin = Clock::now();
    while (answers.size() < ranks.size() && seconds_since(begin) < patience_s) {
      if (auto message = farm_.poll())
        answers[message->from] = std::move(message->body);
      else
        Farm::nap();
    }
    for (const int rank : ranks)
      if (answers.count(rank) == 0) silent_.insert(rank);
    return answers;
  }

  std::vector<int> others() const {
    std::vector<int> ranks;
    for (int rank = 1; rank < farm_.size(); ++rank)
      if (silent_.count(rank) == 0) ranks.push_back(rank);
    return ranks;
  }

  bool ask_for_facts() {
    facts_.push_back(own_facts(farm_.host()));
    for (const auto& [rank, text] : ask(others(), "facts\n")) facts_.push_back(unpack_facts(text));
    if (silent_.empty()) return true;
    add({{Level::problem, "ranks",
          fmt::format("{} of {} do not answer (rank {} ...)", silent_.size(), farm_.size(), *silent_.begin()),
          "the network between the nodes: try `mpirun --mca btl_tcp_if_include NETWORK`, and ask the cluster's "
          "administrators which"}});
    return false;
  }

  /// One rank on each host, each in turn.
  void time_messages() {
    std::set<std::string> hosts;
    double least = 0, most = 0;
    std::size_t num = 0;
    for (std::size_t rank = 1; rank < facts_.size() && num < most_partners; ++rank) {
      if (!hosts.insert(facts_[rank].host).second) continue;
      const std::optional<double> us = round_trip_us(static_cast<int>(rank));
      if (!us) continue;
      least = num == 0 ? *us : std::min(least, *us);
      most = std::max(most, *us);
      ++num;
    }
    if (num == 0) return;
    report_.round_trip_us = most;
    const bool slow = most > slow_round_trip_us;
    add({{slow ? Level::warning : Level::ok, "messages",
          fmt::format("there and back in {:.0f} us{}", most,
                      num == 1 ? "" : fmt::format(" at most, {:.0f} at least, to {} hosts", least, num)),
          slow ? "slow: more ranks than cores, or a slow network; harmless for designs of seconds and more" : ""}});
  }

  std::optional<double> round_trip_us(int rank) {
    std::array<double, num_pings> us{};
    for (double& time : us) {
      const auto begin = Clock::now();
      farm_.send(rank, Tag::check, "ping\n");
      while (!farm_.poll()) {
        std::this_thread::yield();
        if (seconds_since(begin) > patience_s) {
          silent_.insert(rank);
          return std::nullopt;
        }
      }
      time = 1e6 * seconds_since(begin);
    }
    std::sort(us.begin(), us.end());
    return us[us.size() / 2];
  }

  void examine_folder() {
    const FolderCheck folder(options_.folder);
    add(folder.findings());
    report_.write_ms = folder.write_ms();
    if (!folder.writable() || farm_.size() == 1) return;

    std::set<std::string> blind, lockless;
    const auto host_of = [&](int rank) { return facts_.at(static_cast<std::size_t>(rank)).host; };
    for (const auto& [rank, text] :
         ask(others(), fmt::format("look\n{}\n{}\n{}\n", folder.probe(), folder.token(), folder.lock()))) {
      const auto answer = lines_of(text);
      if (answer.at(0) != "seen") blind.insert(host_of(rank));
      if (answer.at(0) == "seen" && answer.at(1) != "held") lockless.insert(host_of(rank));
    }
    if (!blind.empty())
      add({{Level::problem, "shared folder",
            fmt::format("what rank 0 writes is not there for the ranks on {}", fmt::join(blind, ", ")),
            "put the output on a file system that all nodes share"}});
    else
      add({{Level::ok, "shared folder", "what rank 0 writes is there for all ranks", ""}});
    if (folder.locked() && !lockless.empty())
      add({{Level::warning, "shared locks",
            fmt::format("a lock of rank 0 is not seen on {}", fmt::join(lockless, ", ")),
            "two runs on one output folder would not notice each other: never start two"}});
  }

  Farm& farm_;
  const DoctorOptions& options_;
  DoctorReport report_;
  std::vector<RankFacts> facts_;  ///< by rank
  std::set<int> silent_;
};

/// Standard output of a command; nothing when it fails.
std::optional<std::string> output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string out;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) out += buffer.data();
  while (!out.empty() && std::isspace(static_cast<unsigned char>(out.back())) != 0) out.pop_back();
  return ::pclose(pipe) == 0 && !out.empty() ? std::optional(out) : std::nullopt;
}

Finding time_left() {
  const char* job = std::getenv("SLURM_JOB_ID");
  if (job == nullptr) return {Level::ok, "Slurm", "not in a job", ""};
  const std::string id = job;
  const bool is_number = !id.empty() && std::all_of(id.begin(), id.end(), [](char c) { return c >= '0' && c <= '9'; });
  const auto left = is_number ? output_of("squeue -h -j " + id + " -o %L 2>/dev/null") : std::nullopt;
  if (!left)
    return {Level::warning, "Slurm", fmt::format("job {}: squeue does not say how much time is left", id),
            "nothing, unless you rely on it"};
  bool short_time = false;
  try {
    short_time = slurm_time_s(*left) < 180;
  } catch (const InputError&) {
    // UNLIMITED
  }
  return {short_time ? Level::warning : Level::ok, "Slurm", fmt::format("job {}: {} left", id, *left),
          short_time ? "little for a sweep; what is done stays, submit again" : ""};
}

}  // namespace

bool DoctorReport::usable() const {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.level == Level::problem; });
}

DoctorReport examine(Farm& farm, const DoctorOptions& options) { return Examination(farm, options).run(); }

void serve_examination(Farm& farm) {
  // Answers at once while it is being timed, and sleeps otherwise.
  bool timed = false;
  for (auto last = Clock::now(); !farm.orphaned() && seconds_since(last) < 2 * patience_s;) {
    const std::optional<Message> message = farm.poll();
    if (!message) {
      timed ? std::this_thread::yield() : Farm::nap();
      timed = timed && seconds_since(last) < 0.1;
      continue;
    }
    last = Clock::now();
    const auto question = lines_of(message->body);
    timed = question.at(0) == "ping";
    if (question.at(0) == "facts") farm.send(0, Tag::check, pack_facts(own_facts(farm.host())));
    if (question.at(0) == "ping") farm.send(0, Tag::check, "");
    if (question.at(0) == "look") farm.send(0, Tag::check, look(question.at(1), question.at(2), question.at(3)));
    if (question.at(0) == "end") break;
  }
  farm.close();
}

std::vector<Finding> examine_surroundings(bool launched) {
  std::vector<Finding> findings{time_left()};
  if (const char* threads = std::getenv("OMP_NUM_THREADS"))
    findings.push_back({Level::warning, "environment", fmt::format("OMP_NUM_THREADS = {} has no effect here", threads),
                        "`run --threads` sets the threads of a rank"});
  const bool root_allowed =
      std::getenv("OMPI_ALLOW_RUN_AS_ROOT") != nullptr && std::getenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM") != nullptr;
  if (::geteuid() == 0 && !launched && !root_allowed)
    findings.push_back({Level::warning, "environment", "you are root, whom mpirun refuses",
                        "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1, or be another user"});
  findings.push_back({Level::ok, "versions",
                      fmt::format("drumsweep {}, {}, HDF5 {}, compiled by GCC {}", DRUMSWEEP_VERSION, mpi_library(),
                                  hdf5_version(), __VERSION__),
                      ""});
  return findings;
}

}  // namespace drumsweep
