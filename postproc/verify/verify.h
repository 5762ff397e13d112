/// The proof: scenes with a known answer (closed form, measured data, or the independent smooth step), each compared with a band that
/// was fixed before. `drumsweep verify` prints the table.
///
/// To add a case: a function in a file beside this one, and a line in verify_groups().
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace drumsweep {

struct VerifyCase {
  std::string name;      ///< what is compared, with its unit in brackets
  std::string source;    ///< formula or publication
  std::string expected;  ///< in words or numbers
  double low, high;      ///< accepted band
  double got;
  std::string note;  ///< shown with the row; why it fails, where it does

  bool pass() const { return got >= low && got <= high; }
};

struct VerifyOptions {
  bool full = false;              ///< more and larger cases; hours instead of minutes
  std::string folder;             ///< existing; for plots and their data
  std::function<bool()> goes_on;  ///< false: stop as soon as possible
};

struct VerifyGroup {
  const char* name;
  const char* about;
  std::vector<VerifyCase> (*run)(const VerifyOptions& options);
};
std::span<const VerifyGroup> verify_groups();

/// Rows for a quantity with a known value: accepted is expected * (1 -+ tolerance).
VerifyCase within(std::string name, std::string source, double expected, double tolerance, double got);

/// "name,source,expected,low,high,got,pass,note"
std::string verify_csv(const std::vector<VerifyCase>& cases);

/// Rows of a measured table that ships with the program ("oblique_impact_kharaz2001"): comment and header lines left out.
/// @return (rows x columns)
std::vector<std::vector<double>> anchor_table(const std::string& name);

}  // namespace drumsweep
