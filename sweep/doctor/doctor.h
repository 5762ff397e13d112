/// Is this machine, this MPI, this file system fit for a sweep? Each rank says what it has, rank 0 asks and judges.
#pragma once

#include <string>

#include "sweep/doctor/finding.h"
#include "sweep/farm/farm.h"

namespace drumsweep {

struct DoctorOptions {
  std::string folder = ".";  ///< where results would go; need not exist
  int threads = 1;           ///< that each rank would use
};

struct DoctorReport {
  std::vector<Finding> findings;
  int ranks = 1;
  double write_ms = 0;       ///< of a durable write of 0.3 MB, median; 0: not possible
  double round_trip_us = 0;  ///< of a message from rank 0 to another and back, the slowest median; 0: one rank
  bool usable() const;       ///< no problem among the findings
};

/// Rank 0. Takes about a second. A rank that does not answer within half a minute is a problem, no hang.
DoctorReport examine(Farm& farm, const DoctorOptions& options);

/// Every other rank: answers until it is told to go.
void serve_examination(Farm& farm);

/// What one process can say without the others: environment, Slurm, versions.
std::vector<Finding> examine_surroundings(bool launched);

}  // namespace drumsweep
