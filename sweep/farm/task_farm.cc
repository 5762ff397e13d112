#include "sweep/farm/task_farm.h"

#include <fmt/format.h>

#include <chrono>
#include <deque>
#include <exception>
#include <map>

#include "sweep/stop.h"

namespace drumsweep {
namespace {

using Clock = std::chrono::steady_clock;

/// Rank 0 waits this long for the others to leave. After SIGTERM from mpirun there is one second until SIGKILL.
constexpr auto patience = std::chrono::seconds(10);

class TaskMaster {
 public:
  TaskMaster(Farm& farm, const TaskJob& job)
      : farm_(farm), job_(job), waiting_(job.tasks.begin(), job.tasks.end()), work_(job.work) {}

  TaskOutcome run() {
    hand_out(job_.text);
    if (!stopping() && job_.more) ask_for_more();
    if (stopping()) note_stop(stop_signal());
    say_goodbye();
    if (trouble_) std::rethrow_exception(trouble_);
    return {cause_.empty(), cause_};
  }

 private:
  bool stopping() const { return !cause_.empty() || trouble_ || stop_requested(); }
  void note_stop(const std::string& cause) {
    if (cause_.empty()) cause_ = cause.empty() ? "stopped" : cause;
  }

  /// Until all that waits is stored, or something stops it.
  void hand_out(const std::string& text) {
    farm_.send_all(Tag::study, text);
    for (int rank = 1; rank < farm_.size(); ++rank) give(rank);
    while (!stopping() && !waiting_.empty()) {
      const std::size_t task = waiting_.front();
      waiting_.pop_front();
      own_ = true;
      const std::string result = work_(task, [this] {
        serve();
        return !stopping();
      });
      own_ = false;
      if (result.empty()) {
        note_stop(stop_requested() ? stop_signal() : "a task has ended without a result");
        break;
      }
      keep(task, result);
    }
    while (!stopping() && !busy_.empty()) {
      serve();
      farm_.rest();
    }
  }

  void ask_for_more() {
    try {
      MoreTasks more = job_.more();
      waiting_.assign(more.tasks.begin(), more.tasks.end());
      work_ = std::move(more.work);
      if (!waiting_.empty()) hand_out(more.text);
    } catch (...) {
      trouble_ = std::current_exception();  // the others must not be left waiting
    }
  }

  void give(int rank) {
    if (stopping() || waiting_.empty()) return;
    busy_[rank] = waiting_.front();
    farm_.send(rank, Tag::design, std::to_string(waiting_.front()));
    waiting_.pop_front();
  }

  void keep(std::size_t task, const std::string& result) {
    // What goes wrong here must not pass through the simulation that is asking whether to go on.
    try {
      job_.store(task, result);
      ++done_;
    } catch (...) {
      trouble_ = std::current_exception();
    }
  }

  void serve() {
    while (const std::optional<Message> message = farm_.poll()) take(*message);
    if (job_.progress) job_.progress(done_, busy_.size() + (own_ ? 1 : 0));
  }

  void take(const Message& message) {
    if (message.tag == Tag::bye) ++byes_;
    if (message.tag == Tag::broken) {
      busy_.erase(message.from);
      note_stop(message.body);
    }
    if (message.tag != Tag::done) return;
    const std::size_t line = message.body.find('\n');
    busy_.erase(message.from);
    if (message.body.size() > line + 1) keep(std::stoul(message.body.substr(0, line)), message.body.substr(line + 1));
    give(message.from);
  }

  void say_goodbye() {
    farm_.send_all(Tag::stop, "");
    const auto begin = Clock::now();
    while (byes_ + 1 < farm_.size() && Clock::now() - begin < patience) {
      if (const std::optional<Message> message = farm_.poll())
        take(*message);
      else
        Farm::nap();
    }
    if (byes_ + 1 == farm_.size()) farm_.close();
  }

  Farm& farm_;
  const TaskJob& job_;
  std::deque<std::size_t> waiting_;
  Work work_;
  std::map<int, std::size_t> busy_;  ///< rank -> its task
  std::size_t done_ = 0;
  bool own_ = false;
  int byes_ = 0;
  std::string cause_;
  std::exception_ptr trouble_;
};

}  // namespace

TaskOutcome hand_out_tasks(Farm& farm, const TaskJob& job) { return TaskMaster(farm, job).run(); }

void serve_tasks(Farm& farm, const std::function<Work(const std::string& text)>& make_work) {
  Work work;
  bool told_to_stop = false, gave_up = false;
  const auto give_up = [&](const std::string& cause) {
    if (!gave_up) farm.send(0, Tag::broken, cause);
    gave_up = true;
  };
  const auto handle = [&](const Message& message) {
    if (message.tag == Tag::study) {
      work = make_work(message.body);
    } else if (message.tag == Tag::design) {
      const std::string result = work(std::stoul(message.body), [&] {
        while (const std::optional<Message> other = farm.poll())
          if (other->tag == Tag::stop) told_to_stop = true;
        return !told_to_stop && !stop_requested() && !farm.orphaned();
      });
      farm.send(0, Tag::done, message.body + "\n" + result);
    } else {
      told_to_stop = true;
    }
  };
  const auto begin = Clock::now();
  auto gave_up_at = begin;
  while (!told_to_stop) {
    if (farm.orphaned()) return;
    try {
      if (stop_requested() && !gave_up) give_up(fmt::format("rank {} got {}", farm.rank(), stop_signal()));
      if (const std::optional<Message> message = farm.poll()) {
        handle(*message);
        continue;
      }
    } catch (const std::exception& error) {
      give_up(fmt::format("rank {} on {}: {}", farm.rank(), farm.host(), error.what()));
    }
    if (!gave_up) gave_up_at = Clock::now();
    if (Clock::now() - gave_up_at > 2 * patience) return;  // rank 0 does not answer
    farm.rest();
  }
  farm.send(0, Tag::bye, "");
  farm.close();
}

}  // namespace drumsweep
