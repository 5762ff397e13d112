/// The books of a sweep on rank 0: which designs are wanted, which are stored, which are still to be simulated. Knows
/// nothing of ranks and messages; the only rank-like thing here is a design's death with its process (casualties.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/farm/casualties.h"
#include "sweep/plan/findings.h"
#include "sweep/plan/planner.h"
#include "sweep/progress.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results_image.h"
#include "sweep/store/store.h"

namespace drumsweep {

class Agenda {
 public:
  /// Called between two designs of a long look-up; false ends it.
  using GoOn = std::function<bool()>;

  /// Opens the folder and locks it. @throws InputError, MismatchError, LockHeldError, WriteError
  Agenda(const Study& study, const std::string& folder, Reporter& reporter);
  Agenda(const Agenda&) = delete;
  Agenda& operator=(const Agenda&) = delete;

  Store& store() { return store_; }
  const OutputPaths& paths() const { return store_.paths(); }
  Provenance& provenance() { return *provenance_; }
  const Plan& plan() const { return planner_.plan(); }
  /// No search will ask for more.
  bool complete() const { return planner_.complete(); }
  bool finished() const { return complete() && num_rows_ == plan().designs.size(); }

  /// What became of designs that were under way when the last run ended; takes back failures where asked to.
  void settle_the_past(bool retry_failed, bool retry_lost);
  /// Looks up everything that is stored, and lets searches ask for more as long as they find it stored too.
  /// @param steady  whether the warm drum was: rows of an unsteady one are untrusted
  void take_stock(bool steady, const GoOn& go_on);
  /// take_stock() has looked at all that was stored.
  bool stocked() const { return stocked_; }

  // Designs to simulate, the next one first.
  bool has_pending() const { return !pending_.empty(); }
  std::optional<std::size_t> take();
  void put_back(std::size_t index) { pending_.push_front(index); }
  /// Searches may ask for more once nothing is pending. True when they have.
  bool refill(const GoOn& go_on);

  /// Makes the row of a design that a rank has ended. The row comes from the file, so what is called done is what can
  /// be read. @throws WriteError when it cannot
  const ResultRow& enter(std::size_t index);
  /// The rank that had this design has died. True when the design is pending again: it had no result, and is not in
  /// quarantine.
  bool bury(std::size_t index, int rank);

  std::size_t num_rows() const { return num_rows_; }
  ResultTable table() const;
  /// Rebuilds results.csv and results.h5 where they are not the same already, and packs recordings once there are many.
  /// Not before all stored designs have been looked at: a stop during that must not shorten the table.
  void write_tables();
  /// The same once the last time is a while ago.
  void write_tables_now_and_then();
  /// Of a finished look at all rows.
  std::optional<Findings> write_findings();

 private:
  bool grow(const GoOn& go_on, bool& going_on);
  bool extend_plan();
  void publish_plan() const;
  bool look_up_new_designs(const GoOn& go_on);
  void set_row(std::size_t i, ResultRow row);
  bool load_row(std::size_t i);
  bool in_quarantine(std::size_t i);
  void put_suspects_last();
  RowOf row_of() const;
  void replace(const std::string& path, const std::string& text) const;

  const Study& study_;
  Reporter& reporter_;
  Planner planner_;
  Store store_;
  RecordingIndex recordings_;
  KnownRows known_;  ///< from results.h5 of an earlier run
  std::optional<Provenance> provenance_;
  std::optional<Casualties> casualties_;
  bool steady_ = false;
  std::vector<std::optional<ResultRow>> rows_;  ///< (num_designs) of the table
  std::deque<std::size_t> pending_;             ///< designs to simulate
  std::size_t num_rows_ = 0;
  bool stocked_ = false;
  std::chrono::steady_clock::time_point table_written_{};
};

}  // namespace drumsweep
