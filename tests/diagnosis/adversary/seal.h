/// The seal of hidden cases. Three folders: DATA/CASE/measured.csv with commitment.txt (SHA-256 of the key) is all that a diagnosis gets;
/// KEYS/CASE.txt is the key; VERDICTS/CASE.txt is what the diagnosis said. Scoring opens the keys, only when every case has its verdict,
/// and writes VERDICTS/opened.txt with the digest of each: a verdict that was written or changed after that is refused.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/adversary/hide.h"

namespace drumsweep {

/// What a diagnosis has said, as far as it is scored.
struct Statement {
  std::string verdict;
  double p_value = 1;
  struct Named {
    std::string id;
    double strength, low, high;
  };
  std::vector<std::vector<Named>> causes;
  double gain_low = 0, gain_high = 0;
  bool gain_adopted = false;
};
Statement statement_of(const Problem& problem, const Diagnosis& found);
std::string to_text(const Statement& statement);
Statement parse_statement(const std::string& text);

/// What a verdict is worth once the seal is open.
enum class Judgement { right, in_set, misnamed, refused, missed };
/// Whether a member of the set is the truth, whatever its strengths.
bool is_truth(const HiddenTruth& truth, const std::vector<Statement::Named>& cause);
Judgement judge(const HiddenTruth& truth, const Statement& said);
const char* to_text(Judgement judgement);

/// Hides a case: data and commitment in DATA/CASE, the key in KEYS.
void seal_case(const std::string& data, const std::string& keys, const std::string& name, const MeasuredData& measured,
               const std::string& key);

struct OpenedCase {
  std::string name;
  HiddenTruth truth;
  Statement said;
};
/// @throws InputError: a case without verdict, a key that is not the one committed to, a verdict newer than the opening
std::vector<OpenedCase> open_seal(const std::string& data, const std::string& keys, const std::string& verdicts);

}  // namespace drumsweep
