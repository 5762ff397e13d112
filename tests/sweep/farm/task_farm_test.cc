#include "sweep/farm/task_farm.h"

#include <gtest/gtest.h>

#include <map>

#include "core/io/durable_file.h"

namespace drumsweep {

TEST(TaskFarm, one_rank_does_every_task_once) {
  Farm farm;
  std::map<std::size_t, std::string> stored;
  TaskJob job;
  job.tasks = {4, 1, 9};
  job.work = [](std::size_t task, const GoOn& go_on) { return go_on() ? std::to_string(task * task) : ""; };
  job.store = [&](std::size_t task, const std::string& result) { EXPECT_TRUE(stored.emplace(task, result).second); };
  const TaskOutcome outcome = hand_out_tasks(farm, job);
  EXPECT_TRUE(outcome.finished) << outcome.stop_cause;
  EXPECT_EQ(stored, (std::map<std::size_t, std::string>{{1, "1"}, {4, "16"}, {9, "81"}}));
}

TEST(TaskFarm, more_tasks_may_follow_from_the_first_results) {
  Farm farm;
  std::map<std::size_t, std::string> stored;
  TaskJob job;
  job.tasks = {1, 2};
  job.work = [](std::size_t task, const GoOn&) { return std::to_string(task); };
  job.store = [&](std::size_t task, const std::string& result) { stored[task] = result; };
  job.more = [&]() -> MoreTasks {
    EXPECT_EQ(stored.size(), 2u);
    return {"", {7}, [](std::size_t task, const GoOn&) { return "more " + std::to_string(task); }};
  };
  EXPECT_TRUE(hand_out_tasks(farm, job).finished);
  EXPECT_EQ(stored, (std::map<std::size_t, std::string>{{1, "1"}, {2, "2"}, {7, "more 7"}}));
}

TEST(TaskFarm, what_cannot_be_stored_stops_it) {
  Farm farm;
  TaskJob job;
  job.tasks = {1, 2, 3};
  int worked = 0;
  job.work = [&](std::size_t, const GoOn&) {
    ++worked;
    return std::string("result");
  };
  job.store = [](std::size_t, const std::string&) { throw WriteError("disk full"); };
  EXPECT_THROW(hand_out_tasks(farm, job), WriteError);
  EXPECT_EQ(worked, 1);
}

}  // namespace drumsweep
