#include "postproc/result_table.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string_view>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

// The columns, with those of the variables between the two lists.
constexpr std::array<std::string_view, 3> first_columns = {"design_id", "stage", "state"};
constexpr std::array<std::string_view, 14> last_columns = {
    "f_m",        "sigma_f_m", "f_footprint_m", "sigma_f_footprint_m", "max_an_over_a0", "mean_height_m", "landed",
    "lost_balls", "residual",  "overlap_95",    "force_balance_m_s",   "iterations",     "state_hash",    "reason"};

struct Record {
  std::size_t line = 0;  ///< where it begins, from 1
  std::vector<std::string> cells;
};

/// Splits RFC 4180 text; a quoted cell may hold line breaks.
std::vector<Record> split(const std::string& text, const std::string& file) {
  std::vector<Record> records;
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size();) {
    Record record;
    record.line = line;
    for (bool more_cells = true; more_cells;) {
      std::string cell;
      if (at < text.size() && text[at] == '"') {
        for (++at;;) {
          if (at >= text.size()) throw InputError(fmt::format("{}:{}: a quoted cell is not closed", file, record.line));
          if (text[at] == '"') {
            if (at + 1 >= text.size() || text[at + 1] != '"') break;
            ++at;
          }
          if (text[at] == '\n') ++line;
          cell += text[at++];
        }
        ++at;
        if (at < text.size() && text[at] != ',' && text[at] != '\n' && text[at] != '\r')
          throw InputError(fmt::format("{}:{}: text after the closing quote of a cell", file, line));
      } else {
        while (at < text.size() && text[at] != ',' && text[at] != '\n') cell += text[at++];
        if (!cell.empty() && cell.back() == '\r') cell.pop_back();
      }
      if (at < text.size() && text[at] == '\r') ++at;
      record.cells.push_back(std::move(cell));
      more_cells = at < text.size() && text[at] == ',';
      ++at;  // past the comma or the line break
    }
    ++line;
    records.push_back(std::move(record));
  }
  return records;
}

/// One record's cells, taken from left to right.
class Reader {
 public:
  Reader(const Record& record, const std::vector<std::string>& columns, const std::string& file)
      : record_(record), columns_(columns), file_(file) {}

  std::string text() { return record_.cells[at_++]; }
  double number() { return record_.cells[at_].empty() ? (++at_, ResultRow::none) : parse<double>("a number"); }
  std::int64_t count() { return parse<std::int64_t>("a whole number"); }

 private:
  template <typename Number>
  Number parse(const char* wanted) {
    const std::string& cell = record_.cells[at_];
    Number value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size())
      throw InputError(fmt::format("{}:{}: {} = '{}' is not {}", file_, record_.line, columns_[at_], cell, wanted));
    ++at_;
    return value;
  }

  const Record& record_;
  const std::vector<std::string>& columns_;
  const std::string& file_;
  std::size_t at_ = 0;
};

/// Names of the variables in a header. @throws InputError naming the first column that is not as it must be.
std::vector<std::string> variables_of_header(const Record& header, const std::string& file) {
  const auto expect = [&](std::size_t column, std::string_view name) {
    if (header.cells[column] != name)
      throw InputError(fmt::format("{}:{}: column {} is '{}' and should be '{}'", file, header.line, column + 1,
                                   header.cells[column], name));
  };
  const std::size_t num_fixed = first_columns.size() + last_columns.size();
  if (header.cells.size() < num_fixed)
    throw InputError(
        fmt::format("{}:{}: {} columns in the header, at least {} expected (design_id, stage, state, the "
                    "variables, f_m ... reason)",
                    file, header.line, header.cells.size(), num_fixed));
  const std::size_t num_variables = header.cells.size() - num_fixed;
  for (std::size_t i = 0; i < first_columns.size(); ++i) expect(i, first_columns[i]);
  for (std::size_t i = 0; i < last_columns.size(); ++i)
    expect(first_columns.size() + num_variables + i, last_columns[i]);
  const auto begin = header.cells.begin() + static_cast<std::ptrdiff_t>(first_columns.size());
  return {begin, begin + static_cast<std::ptrdiff_t>(num_variables)};
}

}  // namespace

ResultTable with_means_of_replicates(const ResultTable& table) {
  ResultTable out;
  std::vector<std::size_t> kept;
  for (std::size_t v = 0; v < table.variable_names.size(); ++v)
    if (table.variable_names[v] != "replicate" && table.variable_names[v] != "turns") kept.push_back(v);
  if (kept.size() == table.variable_names.size()) return table;
  for (const std::size_t v : kept) out.variable_names.push_back(table.variable_names[v]);

  struct Mean {
    std::size_t row;  ///< in `out`
    double count = 0, variance = 0, variance_footprint = 0;
  };
  std::map<std::pair<std::string, std::string>, Mean> means;
  for (const ResultRow& row : table.rows) {
    ResultRow reduced = row;
    reduced.variables.clear();
    std::string place;
    for (const std::size_t v : kept) {
      reduced.variables.push_back(row.variables.at(v));
      place += csv_number(row.variables[v]) + ",";
    }
    const auto [known, is_new] = means.try_emplace({row.stage, place}, Mean{out.rows.size()});
    Mean& mean = known->second;
    if (is_new) out.rows.push_back(reduced);
    ResultRow& target = out.rows[mean.row];
    if (!std::isfinite(row.f_m)) continue;
    if (mean.count == 0) target = reduced;
    const double n = ++mean.count;
    mean.variance += row.sigma_f_m * row.sigma_f_m;
    mean.variance_footprint += row.sigma_f_footprint_m * row.sigma_f_footprint_m;
    if (n == 1) continue;
    for (double ResultRow::*value :
         {&ResultRow::f_m, &ResultRow::f_footprint_m, &ResultRow::max_an_over_a0, &ResultRow::mean_height_m})
      target.*value += (row.*value - target.*value) / n;
    target.sigma_f_m = std::sqrt(mean.variance) / n;
    target.sigma_f_footprint_m = std::sqrt(mean.variance_footprint) / n;
    if (row.state != "done") target.state = row.state;
  }
  return out;
}

std::string csv_text(const std::string& text) {
  const bool blank_end = !text.empty() && (text.front() == ' ' || text.back() == ' ');
  if (!blank_end && text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_number(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string to_csv(const ResultTable& table) {
  std::string csv;
  for (std::string_view name : first_columns) csv += fmt::format("{},", name);
  for (const std::string& name : table.variable_names) csv += csv_text(name) + ',';
  for (std::size_t i = 0; i < last_columns.size(); ++i)
    csv += fmt::format("{}{}", last_columns[i], i + 1 < last_columns.size() ? ',' : '\n');

  for (const ResultRow& row : table.rows) {
    if (row.variables.size() != table.variable_names.size())
      throw std::invalid_argument(fmt::format("design {} has {} values for {} variables", row.design_id,
                                              row.variables.size(), table.variable_names.size()));
    csv += csv_text(row.design_id) + ',' + csv_text(row.stage) + ',' + csv_text(row.state) + ',';
    for (double value : row.variables) csv += csv_number(value) + ',';
    for (double value :
         {row.f_m, row.sigma_f_m, row.f_footprint_m, row.sigma_f_footprint_m, row.max_an_over_a0, row.mean_height_m})
      csv += csv_number(value) + ',';
    csv += fmt::format("{},{},", row.landed, row.lost_balls);
    for (double value : {row.residual, row.overlap_95, row.force_balance_m_s, row.iterations})
      csv += csv_number(value) + ',';
    csv += fmt::format("{},{}\n", csv_text(row.state_hash), csv_text(row.reason));
  }
  return csv;
}

ResultTable read_results_csv(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be opened", file));
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (stream.bad()) throw InputError(fmt::format("{}: cannot be read", file));

  const std::vector<Record> records = split(text, file);
  if (records.empty()) throw InputError(fmt::format("{}:1: empty file, a header expected", file));
  const std::vector<std::string>& columns = records.front().cells;
  ResultTable table;
  table.variable_names = variables_of_header(records.front(), file);

  for (std::size_t r = 1; r < records.size(); ++r) {
    const Record& record = records[r];
    if (record.cells.size() != columns.size())
      throw InputError(
          fmt::format("{}:{}: {} cells, {} expected", file, record.line, record.cells.size(), columns.size()));
    Reader cells(record, columns, file);
    ResultRow row;
    row.design_id = cells.text();
    row.stage = cells.text();
    row.state = cells.text();
    for (std::size_t v = 0; v < table.variable_names.size(); ++v) row.variables.push_back(cells.number());
    for (double* value : {&row.f_m, &row.sigma_f_m, &row.f_footprint_m, &row.sigma_f_footprint_m, &row.max_an_over_a0,
                          &row.mean_height_m})
      *value = cells.number();
    row.landed = cells.count();
    row.lost_balls = cells.count();
    for (double* value : {&row.residual, &row.overlap_95, &row.force_balance_m_s, &row.iterations})
      *value = cells.number();
    row.state_hash = cells.text();
    row.reason = cells.text();
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace drumsweep
