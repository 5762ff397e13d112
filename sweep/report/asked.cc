/// What was asked: the study in words and numbers.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/effects/catalogue.h"
#include "core/effects/size_distribution.h"
#include "postproc/report/html.h"
#include "sweep/report/sections.h"
#include "sweep/report/wording.h"

namespace drumsweep {
namespace {

bool varies(const ReportData& data, const std::string& key) {
  return std::find(data.plan.keys.begin(), data.plan.keys.end(), key) != data.plan.keys.end();
}

std::string outlet_words(const ReportData& data) {
  const OutletConfig& o = data.study.outlet;
  std::string text =
      fmt::format("{} m long, {} slots, their bisector at {}° to the axis ({} the rotation)", plain(o.length_m),
                  o.num_slots, plain(o.bisector_angle_deg), o.bisector_sense == "with_rotation" ? "with" : "against");
  if (!varies(data, "outlet.opening_angle_deg") && !varies(data, "outlet.opening_angle_rad"))
    text += std::isnan(o.opening_angle_deg) ? fmt::format("; opening angle {} rad", plain(o.opening_angle_rad))
                                            : fmt::format("; opening angle {}°", plain(o.opening_angle_deg));
  if (!varies(data, "outlet.base_width_m")) text += fmt::format("; base width {} m", plain(o.base_width_m));
  return text;
}

std::string effects_words(const Study& s) {
  std::string text;
  for (const Effect& effect : effect_catalogue()) {
    const double value = get_number(s, effect.key);
    if (value == effect.neutral || std::isnan(value)) continue;
    std::string name = effect.id;
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name,
                        with_unit(value, std::string(effect.unit) == "1" ? "" : effect.unit));
  }
  return text.empty() ? "none beyond Hertz contacts with Coulomb friction" : text;
}

std::string objective_words(const Study& s) {
  const ObjectiveConfig& o = s.objective;
  const std::string weight = o.weights == "uniform"   ? "all with weight 1"
                             : o.weights == "growing" ? "with weights 2<sup>n−1</sup>"
                                                      : "with weights 2<sup>−(n−1)</sup>";
  return fmt::format(
      "<i>f</i> = 1/{} Σ w<sub>n</sub> (|a<sub>−n</sub>| + |a<sub>n</sub>|) over the {}N modes of the bed’s mean "
      "height "
      "across {}, {}; 0 is an even bed. Cells of {} ball diameters, packing {}, slopes up to {}°.",
      o.normalization == "samples" ? "2N" : "N", o.modes > 0 ? fmt::format("lowest {} = ", o.modes) : "",
      o.window == "footprint" ? "the outlet’s footprint" : "the whole belt", weight, plain(o.cell_diameters),
      plain(o.packing), plain(o.friction_angle_deg));
}

std::string ranges_of(const StageConfig& stage, const Plan& plan) {
  std::string text;
  for (const StageVariable& v : stage.variables) {
    const Quantity q = quantity_of(v.key);
    if (!text.empty()) text += "; ";
    text += escaped(q.name) + " ";
    if (!v.values.empty())
      text += fmt::format("{} own values", v.values.size());
    else if (stage.type == "grid")
      text += fmt::format("{} to {} in {} values", plain(v.from), escaped(with_unit(v.to, q.unit)), v.count);
    else
      text += fmt::format("{} to {}", plain(v.from), escaped(with_unit(v.to, q.unit)));
  }
  static_cast<void>(plan);
  return text.empty() ? "the ranges of the earlier stages" : text;
}

}  // namespace

std::string asked_html(const ReportData& data) {
  const Study& s = data.study;
  const double ball_kg = mean_ball_mass(s), turn_s = 2 * std::numbers::pi / s.drum.angular_velocity_rad_s;
  const auto& t = s.drum.texture;
  std::vector<std::pair<std::string, std::string>> facts;
  facts.emplace_back(
      "drum", fmt::format("{} m wide, {} m long, inclined {}°, turning at {} rad/s (a turn in {} s); wall of "
                          "triangles of {} m with {}",
                          plain(s.drum.diameter_m), plain(s.drum.length_m), plain(s.drum.inclination_deg),
                          plain(s.drum.angular_velocity_rad_s), plain(turn_s, 3), plain(s.drum.mesh_resolution_m),
                          t.density_1_m2 > 0 ? fmt::format("{} bumps per m², {} to {} mm high", plain(t.density_1_m2),
                                                           plain(1000 * t.height_min_m), plain(1000 * t.height_max_m))
                                             : "no bumps"));
  facts.emplace_back("outlet", outlet_words(data));
  facts.emplace_back("belt",
                     fmt::format("{} m wide, {} m/s across the axis; the outlet begins {} m from its edge and {} m "
                                 "above it; edges: {}",
                                 plain(s.belt.width_m), plain(s.belt.speed_m_s), plain(s.belt.outlet_begin_m),
                                 plain(s.belt.drop_height_m), escaped(s.belt.edge)));
  facts.emplace_back("feed",
                     fmt::format("{} kg/s, {} balls/s", plain(s.feed.rate_kg_s), plain(s.feed.rate_kg_s / ball_kg)));
  facts.emplace_back(
      "balls", fmt::format("{} mm, {} kg/m³ ({} g each), friction {}, restitution {}",
                           plain(1000 * s.material.diameter_m), plain(s.material.density_kg_m3), plain(1000 * ball_kg),
                           plain(s.material.friction), plain(s.material.restitution)));
  facts.emplace_back("effects", escaped(effects_words(s)));
  facts.emplace_back("step",
                     s.step.method == "smooth"
                         ? std::string("smooth, explicit Hertz–Mindlin forces")
                         : fmt::format("nonsmooth, {} ms, {}",
                                       plain(1000 * s.solver.outer_step_s / static_cast<double>(s.solver.sub_steps)),
                                       s.solver.iterations == 0 ? fmt::format("iterations down to a residual of {} m/s",
                                                                              plain(s.solver.residual_target_m_s))
                                                                : fmt::format("{} iterations", s.solver.iterations)));
  facts.emplace_back(
      "each design",
      fmt::format("starts from the same steady drum, turns {} times to adapt, and is recorded "
                  "for {} turns ({} s)",
                  plain(s.record.adapt_turns), plain(s.record.turns), plain(s.record.turns * turn_s, 3)));
  facts.emplace_back("objective", objective_words(s));

  HtmlTable stages{{{"stage"}, {"type"}, {"searches", false, true}, {"designs", true}, {"ended", true}}, {}, false, 0};
  for (std::size_t i = 0; i < s.stages.size(); ++i)
    stages.rows.push_back({{escaped(s.stages[i].name), ""},
                           {escaped(s.stages[i].type), ""},
                           {ranges_of(s.stages[i], data.plan), ""},
                           {fmt::format("{}", data.status.stages[i].designs), ""},
                           {fmt::format("{}", data.status.stages[i].ended), ""}});
  return "<p>Which outlet lays the most even bed of balls on the belt?</p>\n" + fact_table(facts) + html_of(stages) +
         fmt::format(
             "<details class=\"only-screen\"><summary>The whole study file</summary>\n<pre>{}</pre></details>\n",
             escaped(write_study(s, false)));
}

}  // namespace drumsweep
