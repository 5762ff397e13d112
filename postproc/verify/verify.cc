#include "postproc/verify/verify.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "core/config/schema.h"
#include "postproc/verify/anchors.h"
#include "postproc/verify/groups.h"

namespace drumsweep {

std::span<const VerifyGroup> verify_groups() {
  static constexpr VerifyGroup groups[] = {
      {"oblique_impact", "a ball meets a plate obliquely, closed forms and measured", verify_oblique_impact},
      {"closed_forms", "single balls and clusters: rest, rolling, decay, cohesion, conservation", verify_closed_forms},
      {"static_pile", "a pile in a box: force balance, isostatic contacts without friction", verify_static_pile},
      {"belt_bed", "the automaton of the bed against the bed ball by ball", verify_belt_bed},
      {"column_collapse", "run-out of collapsing columns, measured", verify_column_collapse},
      {"slot_discharge", "discharge through a slot over its width, measured", verify_slot_discharge},
      {"pile_of_pellets", "angle of repose of green pellets, measured", verify_pile_of_pellets},
      {"rotating_drum", "velocity profile, surface angle and speed in a drum of glass balls, measured",
       verify_rotating_drum},
      {"smooth_reference", "the nonsmooth step against explicit Hertz-Mindlin forces: drum and outflow",
       verify_smooth_reference},
  };
  return groups;
}

VerifyCase within(std::string name, std::string source, double expected, double tolerance, double got) {
  const double slack = tolerance * std::abs(expected);
  return {
      std::move(name), std::move(source), fmt::format("{:.5g}", expected), expected - slack, expected + slack, got, ""};
}

std::string verify_csv(const std::vector<VerifyCase>& cases) {
  // Texts may hold commas.
  const auto quoted = [](std::string text) {
    for (std::size_t i = text.find('"'); i != std::string::npos; i = text.find('"', i + 2)) text.insert(i, "\"");
    return fmt::format("\"{}\"", text);
  };
  std::string out = "name,source,expected,low,high,got,pass,note\n";
  for (const VerifyCase& c : cases)
    out += fmt::format("{},{},{},{},{},{},{},{}\n", quoted(c.name), quoted(c.source), quoted(c.expected), c.low, c.high,
                       c.got, c.pass() ? "pass" : "FAIL", quoted(c.note));
  return out;
}

std::vector<std::vector<double>> anchor_table(const std::string& name) {
  for (int a = 0; a < num_embedded_anchors; ++a) {
    if (name != embedded_anchors[a].name) continue;
    std::vector<std::vector<double>> rows;
    std::istringstream lines(embedded_anchors[a].text);
    bool header = true;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      if (!header) {
        std::vector<double> row;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');)
          row.push_back(cell.empty() ? std::nan("") : std::stod(cell));
        rows.push_back(row);
      }
      header = false;
    }
    return rows;
  }
  throw std::logic_error("no anchor table " + name);
}

}  // namespace drumsweep
