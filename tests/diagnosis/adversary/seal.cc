#include "diagnosis/adversary/seal.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "diagnosis/adversary/sha256.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> cases_in(const std::string& data) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(data))
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

Statement statement_of(const Problem& problem, const Diagnosis& found) {
  Statement out{to_text(found.verdict), found.p_value, {}, found.gain.low, found.gain.high, found.gain.adopted};
  for (const Explanation& e : found.causes) {
    out.causes.emplace_back();
    for (const NamedEffect& n : e.effects)
      out.causes.back().push_back({problem.effects[static_cast<std::size_t>(n.effect)].id, n.strength, n.low, n.high});
  }
  return out;
}

std::string to_text(const Statement& s) {
  std::string out = fmt::format("verdict {}\np {}\n", s.verdict, s.p_value);
  for (const auto& cause : s.causes) {
    out += "cause";
    for (const Statement::Named& n : cause) out += fmt::format(" {} {} {} {}", n.id, n.strength, n.low, n.high);
    out += '\n';
  }
  return out + fmt::format("gain {} {} {}\n", s.gain_low, s.gain_high, s.gain_adopted ? 1 : 0);
}

Statement parse_statement(const std::string& text) {
  Statement s;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string word;
    in >> word;
    const auto number = [&] {
      std::string digits;
      return in >> digits ? std::stod(digits) : std::nan("");  // operator>> knows no nan
    };
    if (word == "verdict") in >> s.verdict;
    if (word == "p") s.p_value = number();
    if (word == "cause") {
      s.causes.emplace_back();
      for (std::string id; in >> id;) {
        const double strength = number(), low = number(), high = number();
        s.causes.back().push_back({id, strength, low, high});
      }
    }
    if (word == "gain") {
      s.gain_low = number();
      s.gain_high = number();
      s.gain_adopted = number() > 0;
    }
  }
  return s;
}

bool is_truth(const HiddenTruth& truth, const std::vector<Statement::Named>& cause) {
  return cause.size() == truth.effects.size() &&
         std::all_of(cause.begin(), cause.end(), [&](const Statement::Named& n) {
           return std::any_of(truth.effects.begin(), truth.effects.end(),
                              [&](const auto& effect) { return effect.first == n.id; });
         });
}

Judgement judge(const HiddenTruth& truth, const Statement& said) {
  const bool nothing = said.verdict == to_text(Verdict::nothing_wrong), named = !said.causes.empty();
  if (truth.effects.empty() && truth.listed()) return nothing ? Judgement::right : Judgement::misnamed;
  if (nothing) return Judgement::missed;
  if (!named) return truth.listed() ? Judgement::refused : Judgement::right;
  if (!truth.listed()) return Judgement::misnamed;
  if (std::none_of(said.causes.begin(), said.causes.end(), [&](const auto& cause) { return is_truth(truth, cause); }))
    return Judgement::misnamed;
  return said.causes.size() == 1 ? Judgement::right : Judgement::in_set;
}

const char* to_text(Judgement judgement) {
  switch (judgement) {
    case Judgement::right:
      return "right";
    case Judgement::in_set:
      return "in the set";
    case Judgement::misnamed:
      return "MISNAMED";
    case Judgement::refused:
      return "refused";
    case Judgement::missed:
      break;
  }
  return "missed";
}

void seal_case(const std::string& data, const std::string& keys, const std::string& name, const MeasuredData& measured,
               const std::string& key) {
  fs::create_directories(data + "/" + name);
  fs::create_directories(keys);
  write_durably(data + "/" + name + "/measured.csv", measured_csv(measured));
  write_durably(data + "/" + name + "/commitment.txt", sha256(key) + "\n");
  write_durably(keys + "/" + name + ".txt", key);
}

std::vector<OpenedCase> open_seal(const std::string& data, const std::string& keys, const std::string& verdicts) {
  const std::vector<std::string> names = cases_in(data);
  std::string digests;
  for (const std::string& name : names) {
    const std::string path = verdicts + "/" + name + ".txt";
    if (!fs::exists(path)) throw InputError(path + ": missing; the seal stays closed until every case has its verdict");
    digests += fmt::format("{} {}\n", name, sha256(read_whole_file(path)));
  }
  const std::string opened = verdicts + "/opened.txt";
  if (fs::exists(opened) && read_whole_file(opened) != digests)
    throw InputError(opened + ": the seal was opened with other verdicts; what was said after that does not count");
  write_durably(opened, digests);
  std::vector<OpenedCase> out;
  for (const std::string& name : names) {
    const std::string key = read_whole_file(keys + "/" + name + ".txt");
    if (sha256(key) + "\n" != read_whole_file(data + "/" + name + "/commitment.txt"))
      throw InputError(fmt::format("{}/{}.txt: is not the key that the data's commitment.txt stands for", keys, name));
    out.push_back({name, HiddenTruth::from_key(key), parse_statement(read_whole_file(verdicts + "/" + name + ".txt"))});
  }
  return out;
}

}  // namespace drumsweep
