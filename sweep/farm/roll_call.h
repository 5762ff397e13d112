/// Who is still there, for --survive: Open MPI 4.1 does not say (cluster.md). Everybody says now and then that he is
/// alive, with process id and host; missing is whoever has not been heard for too long, or whose process is gone where
/// it can be looked for (on our own host, at once).
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace drumsweep {

class RollCall {
 public:
  /// @param silence_s  a rank may be silent for so long: more than an outer step and the writing of a checkpoint take
  RollCall(int num_ranks, double silence_s, std::string host);

  std::string here() const;  ///< what we say of ourselves
  /// True a few times in silence_s: time to say it again.
  bool due();

  void heard(int rank);
  void heard(int rank, const std::string& here);
  /// He has left, or is known to be dead: not asked for any more.
  void strike(int rank);
  bool listed(int rank) const { return ranks_[static_cast<std::size_t>(rank)].listed; }
  /// Whether it is listed and not there.
  bool missing(int rank) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    Clock::time_point heard = Clock::now();
    pid_t process = 0;  ///< on our host
    bool listed = true;
  };
  std::vector<Entry> ranks_;
  double silence_s_;
  std::string host_;
  Clock::time_point said_{};
};

}  // namespace drumsweep
