/// results.h5: the table for programs, as a sealed image that is written at the moments of results.csv.
///
///   /results/COLUMN      one dataset a column of results.csv, in its rows' order; attribute `columns` of the group has
///                        the names in the CSV's order; absent numbers are NaN
///   /provenance/...      host, attempts, wall and CPU seconds of each row
///   /recordings/...      CRC-32 and size of the recording that each row was computed from, 0 where there is none
///   /study               text of the study, stages included
///   attributes           program_version, seed, steady
///
/// Hosts and times differ from run to run, so unlike results.csv this file is NOT the same bit for bit; the groups
/// /results, /recordings and /study are.
///
/// A later run takes rows from here instead of evaluating all recordings anew: a row is a function of the study, the
/// recording's bytes and of `steady`. It is taken only where program version, all keys that matter and the checksum
/// agree, the recording's bytes having been read and found undamaged, and after some rows have been computed again and
/// came out the same.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/plan/designs.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"

namespace drumsweep {

/// @param recordings  knows the checksums of the rows' recordings
std::string pack_results(const Study& study, const ResultTable& table, bool steady, const RecordingIndex& recordings,
                         const std::vector<ProvenanceLine>& provenance);

/// The table of a results.h5. @throws StoreError, MismatchError (of another version)
ResultTable unpack_results(const std::string& bytes, const std::string& source);

/// Rows of an earlier run.
class KnownRows {
 public:
  KnownRows() = default;
  /// Whatever is wrong with the file (absent, damaged, of other settings): no row is known then.
  KnownRows(const std::string& path, const Study& study, bool steady);

  /// The row of this recording, with stage and variables of `design`.
  std::optional<ResultRow> find(const PlannedDesign& design, const Checksum& checksum) const;
  /// Computes some rows of the plan again, evenly spread; where one differs none is known any more.
  void confirm(RecordingIndex& recordings, const Study& study, const Plan& plan, bool steady);
  std::size_t size() const { return rows_.size(); }

 private:
  struct Known {
    ResultRow row;
    Checksum checksum;
  };
  std::map<std::string, Known> rows_;
};

/// The row of a stored design: known, evaluated, or failed; none where nothing is stored.
/// @throws StoreError, MismatchError
std::optional<ResultRow> stored_row(RecordingIndex& recordings, const KnownRows& known, const Study& study,
                                    const PlannedDesign& design, bool steady);

}  // namespace drumsweep
