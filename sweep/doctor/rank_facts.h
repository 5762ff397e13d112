/// What a rank knows about itself, and what follows from all of them together.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sweep/doctor/finding.h"

namespace drumsweep {

struct RankFacts {
  std::string host;
  std::vector<int> cpus;             ///< numbers of the CPUs that it may run on, ascending (sched_getaffinity)
  int online_cpus = 1;               ///< of the machine
  std::int64_t available_bytes = 0;  ///< memory of the machine that is free, or that Slurm grants where that is less
  std::string simd;                  ///< instructions in use
  std::string version;               ///< of the program
};

RankFacts own_facts(const std::string& host);

/// As text for a message, and back.
std::string pack_facts(const RankFacts& facts);
RankFacts unpack_facts(const std::string& text);

/// Versions, hosts, binding and cores against ranks, threads, vector instructions, memory. A pure function.
/// @param facts  of all ranks, at least one; one on a machine that no launcher was used on
/// @param threads  that each rank would use
std::vector<Finding> judge_ranks(const std::vector<RankFacts>& facts, int threads);

/// "0-3,8": for people.
std::string cpu_ranges(const std::vector<int>& cpus);

}  // namespace drumsweep
