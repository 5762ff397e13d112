/// Candidate causes, one small TOML file each (diagnosis/candidates, or the user's own beside the campaign):
///
///   id = "outlet_coating"
///   about = "fines adhere to the outlet and narrow its slots"
///   unit = "m"
///   low = 0.0                    # range of the strength phi; 0 is the plain model and must be in it
///   high = 0.006
///   prior_scale = 0.002          # of a (half-)normal prior
///   curve = 1.0                  # below 1 for an effect that saturates: numbers go with phi^curve (problem.h)
///   change = [                   # phi times the factor is added to a number of the input ...
///     { key = "effects.outlet_coating_m", add = 1.0, of = ["study"] },
///     { key = "scene.opening_m", add = -2.0, of = ["slot"] },  # `of`: in conditions of this type only
///   ]
///
/// change: `add` = a: value + a phi; `scale` = a: value (1 + a phi); `below` = key: (1 - phi) times the number there.
/// observe = [ { quantity = "bed_height", scale = 1.0 } ] acts on what is read off instead (a sensor, post-processing); "*" is every
/// quantity, and `condition` restricts it. numerics = true: phi times the difference that a finer computation makes.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign/condition.h"
#include "diagnosis/model/problem.h"

namespace drumsweep {

struct CandidateChange {
  KeyChange::How how;
  std::string key, of_key;
  double factor = 1;
  std::vector<std::string> types;  ///< condition types it acts in; empty: all
};

struct CandidateObservation {
  std::string quantity, condition;  ///< "*" or "": any
  bool scales = false;
  double factor = 1;
};

struct Candidate {
  CandidateEffect effect;
  std::vector<CandidateChange> changes;
  std::vector<CandidateObservation> observations;
  bool numerics = false;
  std::string source;  ///< file or "built in", for messages

  /// What strength phi changes in this condition's input; empty where it acts on nothing.
  std::vector<KeyChange> apply(const Condition& condition, double phi) const;
  /// What strength phi makes of a quantity that was read off.
  double observe(const std::string& condition, const std::string& quantity, double value, double phi) const;
  bool acts_on_input_of(const Condition& condition) const;
};

struct CandidateText {
  const char* id;
  const char* text;
};
extern const CandidateText embedded_candidates[];
extern const int num_embedded_candidates;

/// By id of a built-in one, "sensor_bias:QUANTITY", or path of a file in `folder`. @throws InputError
Candidate find_candidate(const std::string& name, const std::string& folder);
Candidate parse_candidate(const std::string& text, const std::string& source);

}  // namespace drumsweep
