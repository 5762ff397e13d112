/// Numbered tasks for the ranks of a job, each a function of its number alone: rank 0 hands them out and keeps what comes back; the
/// others compute. For campaigns of small runs without a warm drum; a sweep's own loop is master.cc and worker.cc.
///
/// Messages are those of farm.h: study carries the job's text, design the number of a task, done number and result.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sweep/farm/farm.h"

namespace drumsweep {

/// Asked between two steps of a task: go on?
using GoOn = std::function<bool()>;
/// Computes one task; empty when it was stopped. Must not throw: what goes wrong in a run is part of its result.
using Work = std::function<std::string(std::size_t task, const GoOn& go_on)>;

struct TaskOutcome {
  bool finished = false;
  std::string stop_cause;  ///< empty when finished
};

/// What only the first tasks' results show to be needed.
struct MoreTasks {
  std::string text;                ///< as TaskJob::text, for these
  std::vector<std::size_t> tasks;  ///< none: there is nothing more to do
  Work work;
};

struct TaskJob {
  std::string text;                ///< all that another rank needs to make its Work
  std::vector<std::size_t> tasks;  ///< handed out in this order
  Work work;                       ///< of this rank
  std::function<void(std::size_t task, const std::string& result)>
      store;  ///< durable when it returns; may throw WriteError
  std::function<void(std::size_t done, std::size_t running)> progress;  ///< called often; may be empty
  std::function<MoreTasks()>
      more;  ///< asked once, when all tasks are stored; may be empty. The other ranks wait meanwhile
};

/// Rank 0, which computes, too. A signal (stop.h) or an error of storing stops all in good order; what is stored stays.
TaskOutcome hand_out_tasks(Farm& farm, const TaskJob& job);
/// Every other rank. @param make_work  from the job's text
void serve_tasks(Farm& farm, const std::function<Work(const std::string& text)>& make_work);

}  // namespace drumsweep
