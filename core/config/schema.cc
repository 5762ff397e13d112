#include "core/config/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/config/field_table.h"
#include "core/config/stages.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
void add_physics_fields(Physics& s, std::vector<Field>& list) {
  MaterialConfig& m = s.material;
  FieldTable material{list, "material.", Scope::warm_state};
  material.number("diameter_m", m.diameter_m, 1e-4, 1, "of a ball; the mean where sizes differ");
  material.number("density_kg_m3", m.density_kg_m3, 1, 50000, "of a ball");
  material.number("friction", m.friction, 0, 10, "Coulomb coefficient between balls");
  material.number("wall_friction", m.wall_friction, 0, 10, "against walls; left out: as between balls", true);
  material.number("restitution", m.restitution, 0, 1, "of fast collisions between balls (solver.impact_speed_m_s)");
  material.number("wall_restitution", m.wall_restitution, 0, 1, "against walls; left out: as between balls", true);
  material.number("stiffness_N_m15", m.stiffness_N_m15, 1, 1e15,
                  "k of Hertz' law f = k (g^1.5 + c g^0.5 dg/dt), overlap g");
  material.number("damping_s", m.damping_s, 0, 10, "c of the same");
  material.number("youngs_modulus_Pa", m.youngs_modulus_Pa, 1e3, 1e13,
                  "of a ball; where given, k = 4/3 E* sqrt(R*) in place of stiffness_N_m15", true);
  material.number("poisson_ratio", m.poisson_ratio, 0, 0.5, "of a ball");
  material.number("wall_youngs_modulus_Pa", m.wall_youngs_modulus_Pa, 1e3, 1e13,
                  "left out: a rigid wall; only with youngs_modulus_Pa", true);
  material.number("wall_poisson_ratio", m.wall_poisson_ratio, 0, 0.5, "of the wall");

  EffectsConfig& e = s.effects;
  FieldTable effects{list, "effects.", Scope::warm_state};
  effects.number("rolling_friction", e.rolling_friction, 0, 10,
                 "rolling resistance: torque up to this times radius times normal force; 0 = off");
  effects.number("wall_rolling_friction", e.wall_rolling_friction, 0, 10, "against walls; left out: the same", true);
  effects.number("twisting_friction", e.twisting_friction, 0, 10,
                 "twisting resistance: torque about the normal up to this times radius times normal force; 0 = off");
  effects.number("wall_twisting_friction", e.wall_twisting_friction, 0, 10, "against walls; left out: the same", true);
  effects.number("cohesion_force_N", e.cohesion_force_N, 0, 1e6,
                 "cohesion (moisture): pull-off force of two balls of the mean diameter; 0 = off");
  effects.number("wall_cohesion_force_N", e.wall_cohesion_force_N, 0, 1e6, "from walls; left out: the same", true);
  effects.number("cohesion_range_m", e.cohesion_range_m, 0, 0.1, "gap at which cohesion has fallen to nothing");
  effects.text("size_distribution", e.size_distribution, {"lognormal", "normal"}, "of the diameters");
  effects.number("size_spread", e.size_spread, 0, 0.5,
                 "standard deviation of the diameters over their mean; 0 = all alike");
  effects.number("size_cut", e.size_cut, 0.1, 4, "diameters farther than this many standard deviations are not drawn");
  effects.number("outlet_coating_m", e.outlet_coating_m, 0, 1,
                 "thickness of fines on the outlet's walls: narrows each slot by twice that; 0 = clean");
  effects.number("drum_coating_m", e.drum_coating_m, 0, 1, "the same on the drum's wall");
  effects.number("dynamic_friction", e.dynamic_friction, 0, 10,
                 "friction of fast sliding, mu(v) = dynamic + (friction - dynamic) exp(-v / friction_speed_m_s)", true);
  effects.number("friction_speed_m_s", e.friction_speed_m_s, 1e-6, 100, "of the same");
  effects.number("air_density_kg_m3", e.air_density_kg_m3, 0, 100, "air drag, 1.2 in air; 0 = off");
  effects.number("drag_coefficient", e.drag_coefficient, 0, 100, "of a ball in the air");
  effects.number("texture_height_scale", e.texture_height_scale, 0, 10, "multiplies the heights of drum.texture");

  FieldTable step{list, "step.", Scope::warm_state};
  step.text("method", s.step.method, {"nonsmooth", "smooth"},
            "nonsmooth: impulses from a complementarity problem; smooth: explicit Hertz-Mindlin forces, the reference");
  step.number("steps_per_contact", s.step.steps_per_contact, 5, 1000,
              "smooth: time steps in the contact time of a collision ...");
  step.number("contact_speed_m_s", s.step.contact_speed_m_s, 1e-3, 100, "... at this speed");

  FieldTable solver{list, "solver.", Scope::warm_state};
  solver.number("outer_step_s", s.solver.outer_step_s, 1e-7, 0.1, "contact search and feed once per outer step");
  solver.count("sub_steps", s.solver.sub_steps, 1, 1000, "time steps per outer step (smooth: found from the contact)");
  solver.count("iterations", s.solver.iterations, 1, 100000, "Gauss-Seidel passes per time step");
  list.back().or_auto = true;
  solver.number("residual_target_m_s", s.solver.residual_target_m_s, 1e-9, 10,
                "iterations = \"auto\" goes on to this mean residual ...");
  solver.count("max_iterations", s.solver.max_iterations, 1, 1000000, "... or to this many passes");
  solver.scope = Scope::evaluation;
  solver.number("residual_limit_m_s", s.solver.residual_limit_m_s, 0, 100,
                "a design whose mean residual is above it is marked untrusted");
  solver.scope = Scope::warm_state;
  solver.number("speculative_margin", s.solver.speculative_margin, 0, 1,
                "contact rows for gaps up to this fraction of a ball diameter");
  solver.number("impact_speed_m_s", s.solver.impact_speed_m_s, 0, 100,
                "a faster approach is an impact, with material.restitution");
  solver.number("stabilization_steps", s.solver.stabilization_steps, 0, 100,
                "least relaxation time of an overlap, in time steps");
  solver.flag("warm_start", s.solver.warm_start, "start from the last step's impulses");
}

std::vector<Field> fields(Study& s) {
  std::vector<Field> list;
  FieldTable top{list, "", Scope::label};
  top.text("name", s.name, {}, "title in figures and reports");
  top.scope = Scope::warm_state;
  top.count("seed", s.seed, 0, 9007199254740992.0,
            "of texture and feed; the same study and seed give the same table, bit for bit");

  FieldTable drum{list, "drum.", Scope::warm_state};
  drum.number("diameter_m", s.drum.diameter_m, 0.02, 20, "inner diameter");
  drum.number("length_m", s.drum.length_m, 0.02, 1000, "from the closed upper end to the outlet");
  drum.number("inclination_deg", s.drum.inclination_deg, 0, 45, "of the axis, downhill towards the outlet");
  drum.number("angular_velocity_rad_s", s.drum.angular_velocity_rad_s, 0.01, 50, "of drum and outlet");
  drum.number("mesh_resolution_m", s.drum.mesh_resolution_m, 0.001, 1, "edge length of the wall's triangles");
  FieldTable texture{list, "drum.texture.", Scope::warm_state};
  texture.number("density_1_m2", s.drum.texture.density_1_m2, 0, 1e5, "Gaussian bumps per area of wall; 0 = smooth");
  texture.number("height_min_m", s.drum.texture.height_min_m, 0, 1, "bump heights are uniform between these two");
  texture.number("height_max_m", s.drum.texture.height_max_m, 0, 1, "");
  texture.number("width_min_m", s.drum.texture.width_min_m, 1e-4, 1, "bump widths are uniform between these two");
  texture.number("width_max_m", s.drum.texture.width_max_m, 1e-4, 1, "");
  texture.text("width_is", s.drum.texture.width_is, {"sigma", "two_sigma"},
               "the width is one or two standard deviations");

  // The outlet in [outlet] serves the warm-up unless [warmup] names another.
  FieldTable outlet{list, "outlet.", Scope::warm_state};
  outlet.number("length_m", s.outlet.length_m, 0.01, 50, "along the axis");
  outlet.number("opening_angle_deg", s.outlet.opening_angle_deg, 0, 120,
                "full angle by which a slot widens; give it in deg or in rad", true);
  outlet.number("opening_angle_rad", s.outlet.opening_angle_rad, 0, 2, "the same in rad", true);
  outlet.number("base_width_m", s.outlet.base_width_m, 0.001, 10, "width of a slot where the outlet begins");
  outlet.count("num_slots", s.outlet.num_slots, 1, 24, "evenly spaced");
  outlet.number("bisector_angle_deg", s.outlet.bisector_angle_deg, -60, 60,
                "between a slot's bisector and the axis direction on the unrolled wall");
  outlet.text("bisector_sense", s.outlet.bisector_sense, {"with_rotation", "against_rotation"},
              "which way the bisector leans going downhill");
  outlet.text("distance_along", s.outlet.distance_along, {"axis", "bisector"},
              "what the distance s in width(s) = base + 2 s tan(angle/2) runs along");

  FieldTable belt{list, "belt.", Scope::recording};
  belt.number("width_m", s.belt.width_m, 0.02, 50, "across, along the projected drum axis");
  belt.scope = Scope::evaluation;
  belt.number("speed_m_s", s.belt.speed_m_s, 1e-3, 20, "across the drum axis");
  belt.scope = Scope::warm_state;  // it is where the drum, and so every stored ball, stands in the room
  belt.number("outlet_begin_m", s.belt.outlet_begin_m, -10, 50, "where the outlet begins, from the belt's edge");
  belt.scope = Scope::recording;
  belt.number("drop_height_m", s.belt.drop_height_m, 0.001, 10, "of the outlet's lowest point above the belt");
  belt.text("edge", s.belt.edge, {"skirt", "open"},
            "skirt: what lands past an edge slides back inside; open: it is spilled");

  FieldTable feed{list, "feed.", Scope::warm_state};
  feed.number("rate_kg_s", s.feed.rate_kg_s, 0, 1e5, "mass flow into the upper end");
  feed.number("zone_begin_m", s.feed.zone_begin_m, 0, 100, "from the upper end, along the axis");
  feed.number("zone_length_m", s.feed.zone_length_m, 0.001, 100, "along the axis");
  feed.number("zone_width_m", s.feed.zone_width_m, 0.001, 20, "across, centred under the axis");

  add_physics_fields(s, list);

  FieldTable warmup{list, "warmup.", Scope::warm_state};
  warmup.number("window_turns", s.warmup.window_turns, 0.25, 1000,
                "inflow and outflow are compared over windows of this many turns");
  warmup.number("tolerance", s.warmup.tolerance, 1e-4, 1, "steady when |in - out| <= tolerance * in ...");
  warmup.count("windows", s.warmup.windows, 1, 100, "... in this many windows in a row");
  warmup.number("max_turns", s.warmup.max_turns, 0, 1e6, "the warm-up ends here at the latest, and says so");
  warmup.number("opening_angle_deg", s.warmup.opening_angle_deg, 0, 120,
                "outlet of the warm-up, where it is not that of [outlet]", true);
  warmup.number("opening_angle_rad", s.warmup.opening_angle_rad, 0, 2, "the same in rad", true);
  warmup.number("base_width_m", s.warmup.base_width_m, 0.001, 10, "", true);

  FieldTable record{list, "record.", Scope::recording};
  record.number("adapt_turns", s.record.adapt_turns, 0, 1e5, "after the outlet was swapped, before recording");
  record.number("turns", s.record.turns, 1, 1e5, "whole turns recorded");
  record.number(
      "replicate", s.record.replicate, 0, 1e9,
      "whole number; each has its own feed places and outlet texture, after the same warm drum; 0: the seed's");

  FieldTable objective{list, "objective.", Scope::evaluation};
  objective.text("window", s.objective.window, {"belt", "footprint"}, "part of the belt that f_m looks at");
  objective.text("weights", s.objective.weights, {"decaying", "growing", "uniform"},
                 "of mode n: 2^-(n-1), 2^(n-1) as printed in S1, 1");
  objective.text("normalization", s.objective.normalization, {"modes", "samples"},
                 "f is divided by the number of modes N, or of samples 2 N");
  objective.count(
      "modes", s.objective.modes, 1, 1000000,
      "f counts and divides by the lowest so many modes; \"auto\": all that the cells across the belt resolve");
  list.back().or_auto = true;
  objective.number("cell_diameters", s.objective.cell_diameters, 0.5, 100, "bed cell in ball diameters");
  objective.number("packing", s.objective.packing, 0.1, 1, "of the bed on the belt");
  objective.number("friction_angle_deg", s.objective.friction_angle_deg, 1, 80, "steepest slope of the bed");

  FieldTable refine{list, "refine.", Scope::search};
  refine.text("method", s.refine.method, {"bobyqa", "cobyla", "sbplx", "nelder_mead"},
              "of NLopt, in stages of type refine");
  refine.count("starts", s.refine.starts, 1, 1000, "searches side by side, from different designs");
  refine.count("max_evaluations", s.refine.max_evaluations, 1, 100000, "of each start");
  refine.number("tolerance_steps", s.refine.tolerance_steps, 0.01, 1000,
                "a start ends when its steps are this many resolutions small");
  refine.flag("only_if_smooth", s.refine.only_if_smooth,
              "start it only where the fit of the earlier stages says that the surface is smooth enough");
  refine.number("tolerance_f_m", s.refine.tolerance_f_m, 0, 10, "reported: is f of the optimum below it?");
  return list;
}

std::string to_toml(const Field& field) {
  struct {
    bool or_auto;
    std::string operator()(const double* v) const { return toml_number(*v); }
    std::string operator()(const std::int64_t* v) const {
      return or_auto && *v == 0 ? "\"auto\"" : fmt::format("{}", *v);
    }
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const std::string* v) const { return toml_text(*v); }
  } print{field.or_auto};
  return std::visit(print, field.value);
}

std::string accepted(const Field& field) {
  if (std::holds_alternative<bool*>(field.value)) return "true or false";
  if (std::holds_alternative<std::string*>(field.value))
    return field.choices.empty() ? "any text" : fmt::format("{}", fmt::join(field.choices, " | "));
  const bool whole = std::holds_alternative<std::int64_t*>(field.value);
  return fmt::format("{}{} to {}{}", whole ? "whole number, " : "", field.low, field.high,
                     field.or_auto ? ", or \"auto\"" : "");
}

namespace {

/// Empty when the field's value is accepted.
std::string complaint(const Field& field) {
  const auto out_of_range = [&](double v) { return !(v >= field.low && v <= field.high); };
  bool bad = false;
  if (const auto* const* d = std::get_if<double*>(&field.value))
    bad = !(field.optional && std::isnan(**d)) && out_of_range(**d);
  if (const auto* const* i = std::get_if<std::int64_t*>(&field.value))
    bad = out_of_range(static_cast<double>(**i)) && !(field.or_auto && **i == 0);
  if (const auto* const* t = std::get_if<std::string*>(&field.value))
    bad = !field.choices.empty() && std::find(field.choices.begin(), field.choices.end(), **t) == field.choices.end();
  return bad ? fmt::format("{} = {}: accepted is {}", field.key, to_toml(field), accepted(field)) : "";
}

void check_outlet(const OutletConfig& outlet, const DrumConfig& drum, double coating, const std::string& table,
                  const Where& where) {
  const auto fail = [&](const char* key, const std::string& text) {
    throw InputError(where(table + key) + table + key + ": " + text);
  };
  const bool deg = !std::isnan(outlet.opening_angle_deg), rad = !std::isnan(outlet.opening_angle_rad);
  if (deg == rad)
    fail("opening_angle_deg",
         deg ? "given in deg and in rad; give one of the two"
             : "missing; give opening_angle_deg or opening_angle_rad (the unit is part of the key)");
  if (!(outlet.base_width_m - 2 * coating >= 0.001))
    fail("base_width_m",
         fmt::format("slots {} m wide are closed by effects.outlet_coating_m = {}: accepted is at least "
                     "1 mm more than twice the coating",
                     outlet.base_width_m, coating));
  // Slots must leave some wall between them up to the outlet's end.
  const double along = outlet.distance_along == "axis"
                           ? outlet.length_m
                           : outlet.length_m / std::cos(outlet.bisector_angle_deg * std::numbers::pi / 180);
  const double pitch = std::numbers::pi * drum.diameter_m / static_cast<double>(outlet.num_slots);
  const double widest = outlet.base_width_m + 2 * along * std::tan(opening_angle_rad(outlet) / 2);
  if (!(widest < 0.999 * pitch))
    fail(
        deg ? "opening_angle_deg" : "opening_angle_rad",
        fmt::format(
            "slots {:.4g} m wide at the outlet's end overlap: {} slots on a drum of {} m leave room for {:.4g} m each; "
            "use a smaller angle or base width",
            widest, outlet.num_slots, drum.diameter_m, pitch));
}

}  // namespace

void validate_values(const std::vector<Field>& list, const Where& where) {
  for (const Field& field : list)
    if (const std::string text = complaint(field); !text.empty()) throw InputError(where(field.key) + text);
}

void validate_physics(const Physics& p, const Where& where) {
  const auto need = [&](bool ok, const char* key, const std::string& text) {
    if (!ok) throw InputError(where(key) + key + ": " + text);
  };
  const auto given = [](double v) { return !std::isnan(v); };
  need(!given(p.material.wall_youngs_modulus_Pa) || given(p.material.youngs_modulus_Pa),
       "material.wall_youngs_modulus_Pa", "needs material.youngs_modulus_Pa beside it");
  const EffectsConfig& e = p.effects;
  need(e.size_spread * e.size_cut < 0.9 || e.size_distribution == "lognormal", "effects.size_spread",
       fmt::format("{} with size_cut {} draws diameters near zero: accepted is size_spread * size_cut below 0.9",
                   e.size_spread, e.size_cut));
  need(!given(e.dynamic_friction) || e.dynamic_friction <= p.material.friction, "effects.dynamic_friction",
       fmt::format("{} is above material.friction = {}", e.dynamic_friction, p.material.friction));
}

namespace {

/// What the tables must satisfy together.
void validate_together(const Study& study, const Where& where) {
  const auto need = [&](bool ok, const char* key, const std::string& text) {
    if (!ok) throw InputError(where(key) + key + ": " + text);
  };
  const auto& t = study.drum.texture;
  need(t.height_min_m <= t.height_max_m, "drum.texture.height_max_m", "must not be below height_min_m");
  need(t.width_min_m <= t.width_max_m, "drum.texture.width_max_m", "must not be below width_min_m");
  need(t.height_max_m < 0.25 * study.drum.diameter_m, "drum.texture.height_max_m",
       fmt::format("{} m is not below a quarter of the drum's diameter", t.height_max_m));
  need(study.material.diameter_m < 0.2 * study.drum.diameter_m, "material.diameter_m",
       fmt::format("{} m: a ball must be smaller than a fifth of the drum's diameter, {} m", study.material.diameter_m,
                   study.drum.diameter_m));
  need(study.drum.mesh_resolution_m <= 0.1 * study.drum.diameter_m, "drum.mesh_resolution_m",
       fmt::format("{} m is too coarse for a drum of {} m: accepted is up to a tenth of the diameter",
                   study.drum.mesh_resolution_m, study.drum.diameter_m));
  need(study.feed.zone_begin_m + study.feed.zone_length_m <= study.drum.length_m, "feed.zone_length_m",
       fmt::format("the feed zone ends at {} m, beyond the drum's length {} m",
                   study.feed.zone_begin_m + study.feed.zone_length_m, study.drum.length_m));
  need(study.feed.zone_width_m <= 0.9 * study.drum.diameter_m, "feed.zone_width_m",
       fmt::format("{} m does not fit into a drum of {} m: accepted is up to 0.9 of the diameter",
                   study.feed.zone_width_m, study.drum.diameter_m));
  check_outlet(study.outlet, study.drum, study.effects.outlet_coating_m, "outlet.", where);
  check_outlet(warmup_outlet(study), study.drum, study.effects.outlet_coating_m, "outlet.", where);
  validate_physics(study, where);
  need(study.record.turns == std::floor(study.record.turns), "record.turns",
       "whole turns only, so that every slot counts alike");
  need(study.record.replicate == std::floor(study.record.replicate), "record.replicate", "a whole number");
}

/// Sets a number after a look at its range. Giving the outlet's angle in one unit takes it back in the other.
void put_number(Study& study, Field& field, double value) {
  double& target = *std::get<double*>(field.value);
  const double before = target;
  target = value;
  if (!std::isfinite(value) || !complaint(field).empty()) {
    const std::string text = fmt::format("{} = {}: accepted is {}", field.key, value, accepted(field));
    target = before;
    throw InputError(text);
  }
  if (field.key == "outlet.opening_angle_deg") study.outlet.opening_angle_rad = not_given;
  if (field.key == "outlet.opening_angle_rad") study.outlet.opening_angle_deg = not_given;
}

/// The number of that key. @throws InputError, with the nearest key
Field& number_field(std::vector<Field>& list, const std::string& key) {
  std::vector<std::string> keys;
  for (Field& field : list) {
    if (!std::holds_alternative<double*>(field.value)) continue;
    if (field.key == key) return field;
    keys.push_back(field.key);
  }
  const std::string near = did_you_mean(key, keys);
  throw InputError(fmt::format("{}: no such numeric key{}", key, near.empty() ? "" : "; did you mean " + near + "?"));
}

}  // namespace

void validate(const Study& study, const Where& where_or_empty) {
  const Where where = where_or_empty ? where_or_empty : [](const std::string&) { return std::string(); };
  Study copy = study;
  validate_values(fields(copy), where);
  validate_together(study, where);
  validate_stages(study, where);
}

void set_number(Study& study, const std::string& key, double value) {
  std::vector<Field> list = fields(study);
  put_number(study, number_field(list, key), value);
}

double get_number(const Study& study, const std::string& key) {
  Study copy = study;
  std::vector<Field> list = fields(copy);
  return *std::get<double*>(number_field(list, key).value);
}

StudyProbe::StudyProbe(const Study& study) : study_(study) {
  study_.stages.clear();
  fields_ = fields(study_);
  for (std::size_t i = 0; i < fields_.size(); ++i)
    if (std::holds_alternative<double*>(fields_[i].value)) place_.emplace(fields_[i].key, i);
}

Field& StudyProbe::number(const std::string& key) {
  const auto found = place_.find(key);
  return found != place_.end() ? fields_[found->second] : number_field(fields_, key);
}

void StudyProbe::set(const std::string& key, double value) {
  Field& field = number(key);
  for (double* changed :
       {std::get<double*>(field.value), &study_.outlet.opening_angle_deg, &study_.outlet.opening_angle_rad})
    before_.emplace_back(changed, *changed);
  put_number(study_, field, value);
}

double StudyProbe::get(const std::string& key) { return *std::get<double*>(number(key).value); }

void StudyProbe::validate() const {
  validate_together(study_, [](const std::string&) { return std::string(); });
}

void StudyProbe::reset() {
  for (auto change = before_.rbegin(); change != before_.rend(); ++change) *change->first = change->second;
  before_.clear();
}

std::vector<Difference> differences(const Study& stored, const Study& given) {
  Study a = stored, b = given;
  const std::vector<Field> left = fields(a), right = fields(b);
  std::vector<Difference> list;
  for (std::size_t i = 0; i < left.size(); ++i)
    if (to_toml(left[i]) != to_toml(right[i]))
      list.push_back({left[i].key, to_toml(left[i]), to_toml(right[i]), left[i].scope});
  return list;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    // Levenshtein distance, one row at a time.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t replaced = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

double opening_angle_rad(const OutletConfig& outlet) {
  return std::isnan(outlet.opening_angle_deg) ? outlet.opening_angle_rad
                                              : outlet.opening_angle_deg * std::numbers::pi / 180;
}

OutletConfig warmup_outlet(const Study& study) {
  OutletConfig outlet = study.outlet;
  const WarmupConfig& w = study.warmup;
  if (!std::isnan(w.opening_angle_deg) || !std::isnan(w.opening_angle_rad)) {
    outlet.opening_angle_deg = w.opening_angle_deg;
    outlet.opening_angle_rad = w.opening_angle_rad;
  }
  if (!std::isnan(w.base_width_m)) outlet.base_width_m = w.base_width_m;
  return outlet;
}

}  // namespace drumsweep
