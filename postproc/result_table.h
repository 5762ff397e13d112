/// results.csv: one row a design. Only what is a function of study and seed goes in, so that the file is bit for bit
/// the same for any number of ranks and interruptions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace drumsweep {

struct ResultRow {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::string design_id, stage, state;
  std::vector<double> variables;  ///< (num_variables), in the units of the names
  double f_m = none, sigma_f_m = none;
  double f_footprint_m = none, sigma_f_footprint_m = none;
  double max_an_over_a0 = none;
  double mean_height_m = none;
  std::int64_t landed = 0, lost_balls = 0;
  double residual = none;           ///< mean of the natural map [m/s]
  double overlap_95 = none;         ///< 95 % of the pressed contacts overlap less, over the diameter
  double force_balance_m_s = none;  ///< largest of a ball
  double iterations = none;         ///< of the solver, mean
  std::string state_hash;
  std::string reason;  ///< why a design is not done; free text

  bool has_value() const { return state == "done" || state == "untrusted"; }
};

struct ResultTable {
  std::vector<std::string> variable_names;  ///< with unit, e.g. opening_angle_deg
  std::vector<ResultRow> rows;
};

/// Replicates of a design made one row: the columns `replicate` and `turns` go, rows of a stage that agree in all other
/// variables become their mean, with the standard error of that mean from their own errors. A mean of one row is that
/// row. Rows without a value are left out where the design has others.
ResultTable with_means_of_replicates(const ResultTable& table);

/// The table in the order of its rows. Numbers in the shortest form that reads back to the same bits, an empty cell for
/// NaN; text is quoted where RFC 4180 asks for it.
/// @throws std::invalid_argument when a row has not one value a variable.
std::string to_csv(const ResultTable& table);

/// A cell as text: quoted when it holds a comma, a quote, a line break or blanks at an end.
std::string csv_text(const std::string& text);
/// A cell as number: shortest exact form, empty for NaN.
std::string csv_number(double value);

/// Reads what to_csv() wrote. @throws InputError naming file and line for anything else.
ResultTable read_results_csv(const std::filesystem::path& path);

}  // namespace drumsweep
