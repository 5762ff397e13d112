#include "sweep/farm/roll_call.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <sstream>

namespace drumsweep {
namespace {

constexpr double words_per_silence = 8, longest_pause_s = 5;

}  // namespace

RollCall::RollCall(int num_ranks, double silence_s, std::string host)
    : ranks_(static_cast<std::size_t>(num_ranks)), silence_s_(silence_s), host_(std::move(host)) {}

std::string RollCall::here() const { return fmt::format("{} {}", ::getpid(), host_); }

bool RollCall::due() {
  const std::chrono::duration<double> since = Clock::now() - said_;
  if (since.count() < std::min(longest_pause_s, silence_s_ / words_per_silence)) return false;
  said_ = Clock::now();
  return true;
}

void RollCall::heard(int rank) { ranks_[static_cast<std::size_t>(rank)].heard = Clock::now(); }

void RollCall::heard(int rank, const std::string& here) {
  heard(rank);
  std::istringstream words(here);
  pid_t process = 0;
  std::string host;
  if (words >> process >> host && host == host_) ranks_[static_cast<std::size_t>(rank)].process = process;
}

void RollCall::strike(int rank) { ranks_[static_cast<std::size_t>(rank)].listed = false; }

bool RollCall::missing(int rank) const {
  const Entry& entry = ranks_[static_cast<std::size_t>(rank)];
  if (!entry.listed) return false;
  if (entry.process != 0 && ::kill(entry.process, 0) != 0 && errno == ESRCH) return true;
  return std::chrono::duration<double>(Clock::now() - entry.heard).count() > silence_s_;
}

}  // namespace drumsweep
