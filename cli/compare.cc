/// drumsweep compare
#include "sweep/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct CompareArguments {
  std::vector<std::string> folders;
  std::string file;
};

using Line = std::vector<std::string>;

std::string number_or_blank(double value, const char* format) {
  return std::isnan(value) ? "" : fmt::format(fmt::runtime(format), value);
}

/// Keys by their last part where that says which.
std::vector<std::string> titles(const Comparison& all) {
  const auto last_part = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
  std::map<std::string, int> times;
  for (const std::string& key : all.keys) ++times[last_part(key)];
  for (const std::string& name : all.variable_names) ++times[name];
  std::vector<std::string> out;
  for (const std::string& key : all.keys) out.push_back(times[last_part(key)] > 1 ? key : last_part(key));
  return out;
}

/// What people look at first; the file has the rest.
std::vector<Line> table_of(const Comparison& all) {
  Line head = {"folder"};
  const std::vector<std::string> keys = titles(all);
  head.insert(head.end(), keys.begin(), keys.end());
  head.push_back("warm balls");
  head.insert(head.end(), all.variable_names.begin(), all.variable_names.end());
  head.insert(head.end(), {"state", "f mm", "+-", "footprint mm", "+-", "over end %", "holdup", "residual m/s",
                           "overlap %", "cpu s"});
  std::vector<Line> table = {head};
  const auto add = [&](Line line) {
    line.resize(head.size());
    table.push_back(std::move(line));
  };
  for (const ComparedFolder& f : all.folders) {
    Line begin = {f.path};
    begin.insert(begin.end(), f.values.begin(), f.values.end());
    begin.push_back(f.warm_balls ? fmt::format("{}{}", *f.warm_balls, f.steady ? "" : " (not steady)") : "");
    if (f.designs.empty()) add(begin);
    for (const ComparedDesign& d : f.designs) {
      const ResultRow& r = d.row;
      Line line = begin;
      for (const double value : d.variables) line.push_back(number_or_blank(value, "{:g}"));
      line.push_back(r.state);
      for (const double value : {r.f_m, r.sigma_f_m, r.f_footprint_m, r.sigma_f_footprint_m})
        line.push_back(number_or_blank(1e3 * value, "{:.2f}"));
      line.push_back(number_or_blank(100 * d.over_end, "{:.1f}"));
      line.push_back(d.holdup ? std::to_string(*d.holdup) : "");
      line.push_back(number_or_blank(r.residual, "{:.2g}"));
      line.push_back(number_or_blank(100 * r.overlap_95, "{:.1f}"));
      line.push_back(number_or_blank(d.cpu_s, "{:.1f}"));
      add(line);
    }
  }
  return table;
}

void print(const std::vector<Line>& table) {
  std::vector<std::size_t> widths(table.front().size(), 0);
  for (const Line& line : table)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  for (const Line& line : table) {
    std::string text;
    for (std::size_t c = 0; c < line.size(); ++c)
      text += c == 0 ? fmt::format("{:<{}}", line[c], widths[c]) : fmt::format("  {:>{}}", line[c], widths[c]);
    fmt::print("{}\n", text);
  }
}

void run(const CompareArguments& options) {
  if (!options.file.empty()) need_place_for(options.file);
  const Comparison all = compare(options.folders);
  for (const std::string& warning : all.warnings) fmt::print(stderr, "drumsweep: {}\n", warning);
  print(table_of(all));
  if (options.file.empty()) return;
  write_durably(options.file, to_csv(all));
  fmt::print("table: {}\n", options.file);
}

}  // namespace

void add_compare(CLI::App& app, int&) {
  auto options = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand(
      "compare",
      "Output folders of several studies side by side, with the keys in which they differ. Simulates nothing.");
  command->add_option("OUT", options->folders, "output folders of runs")->required();
  command->add_option("-o,--output", options->file, "all numbers as CSV, in SI units");
  command->footer(
      "Example, a convergence study:\n"
      "  for i in 10 25 50; do drumsweep run study/quick.toml --set solver.iterations=$i -o it$i; done\n"
      "  drumsweep compare it10 it25 it50 -o convergence.csv\n"
      "A line a finished design: values of the keys in which the studies differ, the design's variables, f and f of "
      "the\n"
      "outlet's footprint with standard errors [mm], share of the balls that leave over the outlet's end, balls inside "
      "at\n"
      "the end and after the warm-up, mean solver residual, overlap that 95 % of the contacts are below [% of a "
      "diameter],\n"
      "CPU time of the design. To change how stored landings are evaluated, without a run: `drumsweep rescore`.");
  command->callback([options] { run(*options); });
}

}  // namespace drumsweep
