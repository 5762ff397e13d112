/// drumsweep check
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/estimate.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/effects/catalogue.h"
#include "core/scene/scene.h"
#include "core/step/world.h"
#include "sweep/plan/planner.h"
#include "sweep/progress.h"

namespace drumsweep {
namespace {

std::vector<std::string> warnings(const Study& s, const Plan& plan, const CostEstimate& e) {
  std::vector<std::string> list;
  const double d = s.material.diameter_m;
  const auto warn = [&](bool when, const std::string& text) {
    if (when) list.push_back(text);
  };
  warn(e.wall_speed_m_s * e.step_s > 0.25 * d,
       fmt::format(
           "the time step is coarse: the wall moves {:.2g} ball diameters in it (outer_step_s / sub_steps = {:.3g} s); "
           "more sub_steps cost little with fewer iterations",
           e.wall_speed_m_s * e.step_s / d, e.step_s));
  warn(s.drum.mesh_resolution_m > 2 * d, "mesh_resolution_m is above two ball diameters: bumps of the wall are lost");
  warn(e.froude >= 1, "the Froude number is 1 or more: balls go round with the wall");
  warn(s.drum.inclination_deg == 0, "a level drum: residence time and holdup cannot be estimated");
  warn(e.filling > 0.3,
       fmt::format("the drum would be {:.0f} % full: more than about a third is not taken in, the feed will be blocked",
                   100 * e.filling));
  warn(s.feed.rate_kg_s == 0, "the feed is zero: the drum stays empty");
  warn(s.record.turns < 2, "record.turns below 2: the error of f is estimated from very few blocks");
  warn(s.record.adapt_turns < 1, "record.adapt_turns below 1: the recording may still see the outlet of the warm-up");
  warn(
      s.warmup.max_turns * e.turn_s < 2 * e.residence_s,
      fmt::format(
          "warmup.max_turns = {:.4g} is less than two residence times ({:.3g} turns): the warm drum may not get steady",
          s.warmup.max_turns, 2 * e.residence_s / e.turn_s));
  const double end =
      s.belt.outlet_begin_m + s.outlet.length_m * std::cos(s.drum.inclination_deg * std::numbers::pi / 180);
  warn(s.belt.outlet_begin_m < 0 || end > s.belt.width_m,
       fmt::format("the outlet lies over {:.3g} to {:.3g} m, the belt ends at {:.3g} m", s.belt.outlet_begin_m, end,
                   s.belt.width_m));
  for (const StageSummary& stage : plan.stages)
    warn(stage.impossible > 0,
         fmt::format("stage \"{}\": {} designs have no geometry (slots overlap ...) and will be listed as "
                     "failed",
                     stage.name, stage.impossible));
  return list;
}

/// "cohesion 0.01 N, air_drag 1.2 kg m-3": what differs from the plain model.
std::string effects_on(const Study& s) {
  std::string out;
  for (const Effect& effect : effect_catalogue()) {
    const double value = get_number(s, effect.key);
    if (value == effect.neutral || std::isnan(value)) continue;
    out += fmt::format("{}{} {:g}{}", out.empty() ? "" : ", ", effect.id, value,
                       std::string(effect.unit) == "1" ? "" : std::string(" ") + effect.unit);
  }
  return out;
}

void check(const std::string& path, const std::vector<std::string>& changes) {
  if (is_scene_file(path)) {
    const SceneFile file = read_scene(path, changes);
    std::string as_given = path;
    for (const std::string& change : changes) as_given += fmt::format(" --set '{}'", change);
    fmt::print("{}: valid scene \"{}\" ({}); next: drumsweep simulate {} -o result\n", path, file.name, file.type,
               as_given);
    return;
  }
  const Study s = read_study(path, changes);
  const Plan plan = plan_designs(s);
  const CostEstimate e = estimate_cost(s);
  auto simulated = static_cast<double>(
      std::count_if(plan.designs.begin(), plan.designs.end(), [](const auto& d) { return d.impossible.empty(); }));
  for (std::size_t i = 0; i < plan.stages.size(); ++i)
    simulated += static_cast<double>(most_further_designs(s, plan, i));
  const bool searches = std::any_of(plan.stages.begin(), plan.stages.end(), [](const auto& i) { return !i.complete; });

  const std::string iterations = s.step.method == "smooth"  ? ""
                                 : s.solver.iterations == 0 ? ", iterations to a residual of " +
                                                                  fmt::format("{:g} m/s", s.solver.residual_target_m_s)
                                                            : fmt::format(", {} iterations", s.solver.iterations);
  fmt::print("{}: valid study \"{}\"\n\n", path, s.name);
  fmt::print("drum        {} m x {} m, {} deg, {:.4g} s a turn, Froude number {:.3g}\n", s.drum.diameter_m,
             s.drum.length_m, s.drum.inclination_deg, e.turn_s, e.froude);
  fmt::print("step        {}, {:.3g} s, {:.0f} an outer step{}; the wall moves {:.2g} ball diameters a step\n",
             s.step.method, e.step_s, s.solver.outer_step_s / e.step_s, iterations,
             e.wall_speed_m_s * e.step_s / s.material.diameter_m);
  if (const std::string on = effects_on(s); !on.empty()) fmt::print("effects     {}\n", on);
  fmt::print("balls       {} m, {:.4g} g\n", s.material.diameter_m, 1000 * e.ball_kg);
  fmt::print(
      "mass        fed {:.4g} kg/s = {:.4g} balls/s; all of it on the belt makes a mean bed height of {:.4g} m\n",
      s.feed.rate_kg_s, e.balls_per_s, e.bed_height_m);
  if (std::isfinite(e.balls)) {
    fmt::print("\nEstimates (from formulas, to be off by a factor of two at times):\n");
    fmt::print("holdup      {:.3g} balls, residence time {:.3g} s = {:.3g} turns (Sullivan's kiln formula)\n", e.balls,
               e.residence_s, e.residence_s / e.turn_s);
    fmt::print("filling     {:.3g} % of the drum's volume\n", 100 * e.filling);
    fmt::print("memory      {:.3g} MB a rank (1.2 kB a ball)\n", 1e-6 * e.memory_bytes);
    fmt::print("warm-up     {} of one core\n", clock_text(e.warmup_core_s));
    fmt::print("a design    {} of one core ({} + {} turns)\n", clock_text(e.design_core_s), s.record.adapt_turns,
               s.record.turns);
    fmt::print("all         {}{:.3g} core-hours\n", searches ? "at most " : "",
               (e.warmup_core_s + simulated * e.design_core_s) / 3600);
  }

  fmt::print("\n");
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const StageSummary& stage = plan.stages[i];
    if (!stage.complete) {
      fmt::print("stage       \"{}\" ({}): up to {} designs, decided from results\n", stage.name, stage.type,
                 most_further_designs(s, plan, i));
      continue;
    }
    fmt::print("stage       \"{}\": {} designs{}{}\n", stage.name, stage.nodes,
               stage.shared > 0 ? fmt::format(", {} of them shared with an earlier stage", stage.shared) : "",
               stage.impossible > 0 ? fmt::format(", {} impossible", stage.impossible) : "");
  }
  if (plan.stages.empty())
    fmt::print("no stage    nothing to sweep; `drumsweep simulate` runs a single design\n");
  else
    fmt::print("designs     {}{} to simulate, variables: {}\n", searches ? "at most " : "", simulated,
               fmt::join(plan.keys, ", "));
  for (const std::string& text : warnings(s, plan, e)) fmt::print("warning: {}\n", text);
}

}  // namespace

void add_check(CLI::App& app, int&) {
  auto path = std::make_shared<std::string>();
  auto changes = std::make_shared<std::vector<std::string>>();
  CLI::App* command =
      app.add_subcommand("check", "Validate a study; mass balance, balls, memory, core-hours. Runs nothing.");
  command->add_option("STUDY", *path, "study file (TOML)")->required();
  add_set_option(*command, *changes);
  command->footer(
      "Example:\n  drumsweep check study/quick.toml\n"
      "An error names file, line, key and the accepted range, and gives exit code 2. Costs are estimates:\n"
      "`drumsweep bench` measures this machine.");
  command->callback([path, changes] { check(*path, *changes); });
}

}  // namespace drumsweep
