/// diagnosis.txt: the steps as plain text, tables in columns.
#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/report/steps.h"

namespace drumsweep {
namespace {

std::string table_text(const StepTable& table) {
  std::vector<std::size_t> width;
  for (const StepColumn& column : table.columns) width.push_back(column.title.size());
  for (const std::vector<StepCell>& row : table.rows)
    for (std::size_t j = 0; j < row.size(); ++j) width[j] = std::max(width[j], row[j].text.size());
  const auto line = [&](const auto& text_of) {
    std::string out = "   ";
    for (std::size_t j = 0; j < table.columns.size(); ++j)
      out += table.columns[j].number ? fmt::format(" {:>{}} ", text_of(j), width[j])
                                     : fmt::format(" {:<{}} ", text_of(j), width[j]);
    return out.erase(out.find_last_not_of(' ') + 1) + "\n";
  };
  std::string out = fmt::format("\n  {}\n", table.title);
  out += line([&](std::size_t j) { return table.columns[j].title; });
  for (const std::vector<StepCell>& row : table.rows)
    out += line([&](std::size_t j) { return j < row.size() ? row[j].text : std::string(); });
  if (!table.note.empty()) out += fmt::format("    {}\n", table.note);
  return out;
}

}  // namespace

std::string report_text(const DiagnosisReport& r) {
  std::string out = fmt::format("{}\n{}\n", r.campaign.name, headline(r));
  for (const std::string& note : r.notes) out += fmt::format("note: {}\n", note);
  int number = 0;
  for (const DiagnosisStep& step : diagnosis_steps(r)) {
    out += fmt::format("\n{}. {}\n", ++number, step.title);
    for (const std::string& line : step.lines) out += fmt::format("  {}\n", line);
    for (const StepTable& table : step.tables) out += table_text(table);
  }
  return out;
}

}  // namespace drumsweep
