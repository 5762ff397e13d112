/// All that a diagnosis says, step by step, as sentences and tables in plain text: diagnosis.txt prints them and the page
/// sets them, so that both say the same.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/report/report.h"

namespace drumsweep {

struct StepCell {
  std::string text;
  double z = std::nan("");     ///< of a cell that is one: the page shades it
  double sort = std::nan("");  ///< what to sort by where the text is more than a number
};
struct StepColumn {
  std::string title;
  bool number = false;
};
struct StepTable {
  std::string id;  ///< of its kind, for the page to know what to draw beside it
  std::string title;
  std::vector<StepColumn> columns;
  std::vector<std::vector<StepCell>> rows;
  std::string note{};   ///< how it is read
  bool detail = false;  ///< of interest to few
};
struct DiagnosisStep {
  std::string id, title;
  std::vector<std::string> lines;
  std::vector<StepTable> tables;
};

/// Checks, what is wrong, the cause, the extension, the gain, what it changes.
std::vector<DiagnosisStep> diagnosis_steps(const DiagnosisReport& report);

/// Whether there is a measured value to compare with.
bool compared(const Datum& datum);
/// Whether a group of data is said to misfit by itself.
bool misfits(const GroupMisfit& group);

/// "axial_velocity" -> "axial velocity", "sensor_bias:angle" -> "sensor bias of angle".
std::string spoken(const std::string& id);
/// As name_of(), spoken.
std::string spoken_name(const Datum& datum);
/// "0.0026 m"; "0.06" for a number without a unit.
std::string with_its_unit(double value, const std::string& unit);
/// What strength these data would have seen 9 times in 10.
std::string seen_from(const CandidateEffect& effect, const Detection& limit);

/// |z| from which on a difference is pointed out.
inline constexpr double shown_z = 2;

}  // namespace drumsweep
