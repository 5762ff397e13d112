/// One self-contained page about a sweep: the answer first, then what it rests on. Read from the folder alone, so it
/// works while a run is going on and for a sweep that was stopped; what is missing is said where it would stand.
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

struct ReportOptions {
  bool picture = true;  ///< render the warm drum; takes POV-Ray and some seconds
};

struct Report {
  std::string html;
  std::vector<std::string> notes;  ///< what could not be shown and why, one sentence each
};

/// @throws InputError when the folder is not a sweep's, MismatchError when it is of another version
Report make_report(const std::string& folder, const ReportOptions& options);

}  // namespace drumsweep
