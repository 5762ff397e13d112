/// What every rank did when, from provenance.csv alone.
///
/// A design's time is the one its own rank has measured, put where rank 0 heard of its end; so clocks of other machines
/// do not matter. Shares of idle time are those of the time of designs: from the first design that was handed out to the
/// end of the run, tail included. The warm-up before it is shown but not counted: rank 0 computes it with the threads of
/// the others.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sweep/store/provenance.h"

namespace drumsweep {

/// A stretch of time of one rank, in seconds since its run began.
struct TimelineSpan {
  enum class Kind { warm_up, design } kind = Kind::design;
  double begin_s = 0, end_s = 0;
  std::string design_id;
  std::string event;  ///< done, failed, stopped; empty for one that had no end in its run
};

struct RankTimeline {
  int rank = 0;
  std::string host;
  std::vector<TimelineSpan> spans;  ///< in order of time
  double busy_s = 0;                ///< with designs
  double idle_share = 0;            ///< of designs_s
};

struct RunTimeline {
  std::string begin_utc;
  bool active = false;  ///< going on now
  bool orderly = true;  ///< not killed: active, or with a line run_end
  double wall_s = 0;    ///< of the whole run
  double warm_up_s = 0;
  double designs_s = 0;             ///< from the first design to the end
  double idle_s = 0;                ///< in that time, of all ranks
  double idle_share = 0;            ///< idle_s over designs_s of all ranks
  double tail_s = 0;                ///< from the moment the first rank had its last design behind it to the end
  std::size_t designs = 0;          ///< begun
  std::vector<RankTimeline> ranks;  ///< (num_ranks)
};

/// The runs of a folder in order. @param active  a run is going on, and its time is now_s [s since 1970]
std::vector<RunTimeline> timeline_of(const std::vector<ProvenanceLine>& lines, bool active, double now_s);

/// Gantt chart, one row a rank ("w" warm-up, "#" and "=" designs in turn, "." waiting), at most `columns` wide. Of more
/// than 64 ranks those with the most idle time.
std::string chart_of(const RunTimeline& run, std::size_t columns);

}  // namespace drumsweep
