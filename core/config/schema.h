/// The keys of a study file, in one list: reading, validation, help text, canonical output, differences between two
/// studies and design variables all work from fields().
#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/config/study.h"

namespace drumsweep {

/// Wrong input: names file, key, value and what is accepted. The program turns it into exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a key decides, and so what a change of it invalidates.
enum class Scope {
  warm_state,  ///< the warm drum and everything after it
  recording,   ///< the landings of each design
  evaluation,  ///< only numbers computed from stored landings
  search,      ///< which designs are simulated
  label,       ///< nothing
};

/// One key of the study, bound to a Study object.
struct Field {
  std::string key;  ///< "table.name"
  std::variant<double*, std::int64_t*, bool*, std::string*> value;
  double low = -std::numeric_limits<double>::infinity();  ///< accepted range of a number, both ends included
  double high = std::numeric_limits<double>::infinity();
  bool optional = false;             ///< a number that may be left out (NaN)
  std::vector<std::string> choices;  ///< accepted values of a text
  Scope scope = Scope::label;
  std::string help;
  bool or_auto = false;  ///< a whole number for which "auto" may stand; stored as 0
};

/// Gives the place of a key in its file, "file:line:column: ", for messages.
using Where = std::function<std::string(const std::string& key)>;

/// The keys of [material], [effects], [step] and [solver], which studies and scenes share.
void add_physics_fields(Physics& physics, std::vector<Field>& list);

/// Checks each value against its own range, and what the shared tables must satisfy together. @throws InputError
void validate_values(const std::vector<Field>& list, const Where& where);
void validate_physics(const Physics& physics, const Where& where);

/// All keys but the stages, in the order of the file.
std::vector<Field> fields(Study& study);

/// The value of a field as TOML text, doubles with all digits needed to read them back exactly.
std::string to_toml(const Field& field);

/// "0.01 to 20", "one of a, b", ...: the accepted values in words.
std::string accepted(const Field& field);

/// Checks every value against its range and the study as a whole (exactly one opening angle, slots do not overlap ...).
/// @throws InputError naming the key, its value and the accepted range; `where(key)` gives the place in the file.
void validate(const Study& study, const Where& where = {});

/// Sets the number at `key`, converting the outlet's angle where the other unit was given.
/// @throws InputError for an unknown key or a value out of range.
void set_number(Study& study, const std::string& key, double value);
double get_number(const Study& study, const std::string& key);

/// A study whose numbers are set and set back many times, as for the designs of a stage: its keys are listed once. The
/// stages are left out.
class StudyProbe {
 public:
  explicit StudyProbe(const Study& study);
  StudyProbe(const StudyProbe&) = delete;
  StudyProbe& operator=(const StudyProbe&) = delete;

  const Study& study() const { return study_; }
  /// As set_number(). @throws InputError
  void set(const std::string& key, double value);
  double get(const std::string& key);
  /// What the shared tables must satisfy together, as in validate(). Single values were checked by set().
  void validate() const;
  /// Undoes what was set.
  void reset();

 private:
  Field& number(const std::string& key);

  Study study_;
  std::vector<Field> fields_;
  std::map<std::string, std::size_t> place_;  ///< of the numbers in fields_
  std::vector<std::pair<double*, double>> before_;
};

/// Difference of one key between two studies, as text.
struct Difference {
  std::string key, stored, given;
  Scope scope;
};
std::vector<Difference> differences(const Study& stored, const Study& given);

/// The closest of `candidates` to `word`, or empty when none is near (edit distance above a third of its length).
std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates);

/// Opening angle in radians from whichever key was given.
double opening_angle_rad(const OutletConfig& outlet);

/// The outlet that the warm-up uses: the study's, with the keys of [warmup] put over it.
OutletConfig warmup_outlet(const Study& study);

}  // namespace drumsweep
