/// The ranks of a job and the messages between them. The only place that knows MPI; without mpirun there is one rank
/// and MPI is not even started.
///
///   tag         from -> to    body                       meaning
///   study       0 -> r        output folder, study text  a sweep has begun
///   warm        0 -> r        number of bytes, or 0      the warm drum follows by broadcast(); 0: it is in the folder
///   design      0 -> r        assignment (design_run.h)  simulate this one
///   done        r -> 0        outcome of the design      it is stored durably (or failed, or was stopped); wants another
///   broken      r -> 0        cause                      this rank cannot go on (full disk ...): stop all, exit 3
///   checkpoint  0 -> r        -                          write one and go on
///   stop        0 -> r        -                          stop within a step, then say bye
///   bye         r -> 0        -                          nothing more will come from r
///   alive       both          process id, host           --survive: now and then, see roll_call.h
///   end         0 -> r        1 or 0                     --survive: all have said bye; 1: nobody has died, end MPI
///   check       both          see doctor.cc              `drumsweep doctor`, no sweep
///
/// Order between two ranks is kept. Nobody blocks in a receive and nobody spins for long: whoever waits polls, for a
/// moment after a message yielding its core, then sleeping 1 ms at a time, as rank 0 shares its core with its own
/// simulation (a blocking wait of Open MPI takes a whole core: measured, 2.1 times the wall time).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace drumsweep {

enum class Tag { study = 1, warm, design, done, broken, checkpoint, stop, bye, alive, end, check };

struct Message {
  int from;
  Tag tag;
  std::string body;
};

class Farm {
 public:
  /// Starts MPI when a launcher has started us. @throws std::runtime_error when this process is one of several copies
  /// that do not know each other, each of which would believe it is rank 0.
  Farm();
  /// Ends MPI if close() said that all is in order.
  ~Farm();
  Farm(const Farm&) = delete;
  Farm& operator=(const Farm&) = delete;

  int rank() const;
  int size() const;
  std::string host() const;

  /// Never waits: the message is kept until it has gone.
  void send(int to, Tag tag, const std::string& body);
  void send_all(Tag tag, const std::string& body);
  /// The next message, if one is there.
  std::optional<Message> poll();
  /// From rank 0 to all, in pieces (MPI counts are int). All ranks call it; `bytes` has its size on all of them. The
  /// content is a sealed file: whoever unpacks it verifies its checksum.
  void broadcast(std::string& bytes);
  /// True once the launcher has died and left us behind.
  bool orphaned() const;
  /// Says that no rank will communicate any more, so that ending MPI does not wait for anybody.
  void close();

  static void nap();  ///< 1 ms
  /// Between two polls that found nothing: gives the core away, and sleeps once nothing has come for a while.
  void rest();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Name and version of the MPI library.
std::string mpi_library();

}  // namespace drumsweep
