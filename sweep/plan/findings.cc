#include "sweep/plan/findings.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/schema.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
namespace {

std::optional<Confirmation> confirmation_of(const Box& box, const Study& study, const Plan& plan, const RowOf& row_of) {
  for (std::size_t s = plan.stages.size(); s-- > 0;) {
    if (plan.stages[s].type != "replicate") continue;
    // The first design of the stage is the optimum of the fit; the others were added for comparison.
    Confirmation out;
    std::vector<double> values;
    for (const std::size_t i : plan.stages[s].designs) {
      const PlannedDesign& design = plan.designs[i];
      const ResultRow* row = row_of(design);
      const auto point = point_of(box, study, plan, design);
      if (!point) continue;
      if (out.at.empty()) out.at = *point;
      if (*point != out.at || row == nullptr || row->state != "done") continue;
      values.push_back(row->f_m);
      out.max_an_over_a0 += row->max_an_over_a0;
    }
    const auto count = static_cast<double>(values.size());
    if (values.size() < 2) return std::nullopt;
    for (const double f : values) out.f_m += f / count;
    for (const double f : values) out.sigma_m += (f - out.f_m) * (f - out.f_m) / (count * (count - 1));
    out.sigma_m = std::sqrt(out.sigma_m);
    out.num_runs = static_cast<int>(values.size());
    out.max_an_over_a0 /= count;
    out.stop_test = out.max_an_over_a0 <= 0.1;
    if (study.refine.tolerance_f_m > 0) out.below_tolerance = out.f_m < study.refine.tolerance_f_m;
    return out;
  }
  return std::nullopt;
}

std::string list_of(const std::vector<std::string>& items) {
  return items.empty() ? "[]" : fmt::format("[\n  {},\n]", fmt::join(items, ",\n  "));
}

std::string table_of(const Box& box, const Point& point) {
  std::string out;
  for (std::size_t i = 0; i < box.size(); ++i)
    out += fmt::format("{}{} = {}", i == 0 ? "{ " : ", ", toml_text(box[i].key), toml_number(point[i]));
  return out + " }";
}

}  // namespace

std::optional<Findings> find(const Study& study, const Plan& plan, const RowOf& row_of) {
  Findings out;
  out.box = search_box(study, study.stages.size());
  if (out.box.empty()) return std::nullopt;
  const Fit fit = fit_rows(out.box, study, plan, study.stages.size(), row_of);
  out.gate = fit.gate;
  constexpr int least_dof = 10;  // with fewer the ratio of two variances says nothing
  out.shared_noise_gain = fit.noise.scatter_dof >= least_dof ? fit.noise.gain_neighbours : not_given;
  if (fit.surface) out.optimum = optimum(*fit.surface, study.seed);
  out.confirmation = confirmation_of(out.box, study, plan, row_of);
  return out;
}

std::string at_end_of_range(const Findings& findings, std::size_t variable) {
  if (!findings.optimum || variable >= findings.box.size()) return "";
  const DesignAxis& axis = findings.box[variable];
  const double at = findings.optimum->at[variable];
  const char* end = at <= axis.low ? "lower" : at >= axis.high ? "upper" : nullptr;
  return end == nullptr ? "" : fmt::format(", at the {} end of the range that was searched", end);
}

std::string describe(const Findings& f) {
  std::string out;
  if (f.optimum) {
    out += "optimum of the fit, with the range that holds it with 95 %:\n";
    for (std::size_t i = 0; i < f.box.size(); ++i)
      out += fmt::format("  {} = {:.6g}  ({:.4g} to {:.4g}){}\n", f.box[i].key, f.optimum->at[i], f.optimum->low[i],
                         f.optimum->high[i], at_end_of_range(f, i));
    out += fmt::format("  f = {:.4g} +- {:.2g} m\n", f.optimum->f_m, f.optimum->sigma_m);
  }
  out += fmt::format("surface: {}\n", f.gate.reason);
  if (std::isfinite(f.shared_noise_gain))
    out += fmt::format(
        "shared random numbers: the difference of neighbouring designs has {:.2g} times less variance than with "
        "separate "
        "ones\n",
        f.shared_noise_gain);
  if (const auto& c = f.confirmation) {
    out += fmt::format("confirmed by {} fresh runs at", c->num_runs);
    for (std::size_t i = 0; i < f.box.size(); ++i)
      out += fmt::format("{} {} = {:.6g}", i == 0 ? "" : ",", f.box[i].key, c->at[i]);
    out += fmt::format(": f = {:.4g} +- {:.2g} m\n", c->f_m, c->sigma_m);
    out += fmt::format("  largest |a_n| / a_0 = {:.3g}: S1's stop test (0.1) is {}\n", c->max_an_over_a0,
                       c->stop_test ? "met" : "not met");
    if (c->below_tolerance)
      out += fmt::format("  f is {} refine.tolerance_f_m\n", *c->below_tolerance ? "below" : "not below");
  }
  return out;
}

std::string to_toml(const Plan& plan, const std::optional<Findings>& findings) {
  std::string out =
      "# What the stages have decided and found; made anew by every run. Lengths in m, angles as the keys say.\n";
  for (const StageSummary& stage : plan.stages) {
    std::vector<std::string> notes, designs;
    for (const std::string& note : stage.notes) notes.push_back(toml_text(note));
    out += fmt::format("\n[[stage]]\nname = {}\ntype = {}\ncomplete = {}\nnum_designs = {}\nnotes = {}\n",
                       toml_text(stage.name), toml_text(stage.type), stage.complete, stage.nodes, list_of(notes));
    if (stage.type == "grid" || stage.type == "points") continue;
    for (const std::size_t i : stage.designs) {
      std::string values;
      for (const auto& [key, value] : plan.designs[i].values)
        values += fmt::format("{}{} = {}", values.empty() ? "{ " : ", ", toml_text(key), toml_number(value));
      designs.push_back(values + " }");
    }
    // By content, as the order in which results came in is not a result.
    std::sort(designs.begin(), designs.end());
    out += fmt::format("designs = {}\n", list_of(designs));
  }
  if (!findings) return out;
  const GateFigures& g = findings->gate.figures;
  out += fmt::format(
      "\n[surface]\nreason = {}\nsmooth = {}\nnum_rows = {}\nnum_points = {}\nloo_rms_m = {}\nloo_over_sigma = {}\n"
      "loo_chi2 = {}\nq2 = {}\namplitude_over_run = {}\namplitude_over_error = {}\nquadratic_chi2 = {}\nquadratic_p = "
      "{}\n"
      "shared_noise_gain = {}\n",
      toml_text(findings->gate.reason), findings->gate.smooth(), g.num_rows, g.num_points, toml_number(g.loo_rms_m),
      toml_number(g.loo_over_sigma), toml_number(g.loo_chi2), toml_number(g.q2), toml_number(g.amplitude_over_run),
      toml_number(g.amplitude_over_error), toml_number(g.quadratic_chi2), toml_number(g.quadratic_p),
      toml_number(findings->shared_noise_gain));
  if (const auto& o = findings->optimum)
    out += fmt::format("\n[optimum]\nat = {}\nlow_95 = {}\nhigh_95 = {}\nf_m = {}\nsigma_f_m = {}\n",
                       table_of(findings->box, o->at), table_of(findings->box, o->low),
                       table_of(findings->box, o->high), toml_number(o->f_m), toml_number(o->sigma_m));
  if (const auto& c = findings->confirmation) {
    out += fmt::format(
        "\n[confirmation]\nat = {}\nnum_runs = {}\nf_m = {}\nsigma_f_m = {}\nmax_an_over_a0 = {}\nstop_test_met = {}\n",
        table_of(findings->box, c->at), c->num_runs, toml_number(c->f_m), toml_number(c->sigma_m),
        toml_number(c->max_an_over_a0), c->stop_test);
    if (c->below_tolerance) out += fmt::format("below_tolerance = {}\n", *c->below_tolerance);
  }
  return out;
}

void restore_searches(Plan& plan, const Study& study, const std::string& text, const std::string& source) {
  const toml::table root = parse_toml(text, source);
  const toml::array* stages = root["stage"].as_array();
  if (stages == nullptr || stages->size() != plan.stages.size())
    throw InputError(source + ": has not the stages of the study beside it");
  for (std::size_t s = 0; s < plan.stages.size(); ++s) {
    const toml::table* node = (*stages)[s].as_table();
    StageSummary& stage = plan.stages[s];
    if (node == nullptr || (*node)["name"].value<std::string>() != stage.name ||
        (*node)["type"].value<std::string>() != stage.type)
      throw InputError(source + ": has not the stages of the study beside it");
    if (const toml::array* notes = (*node)["notes"].as_array())
      for (const toml::node& note : *notes) stage.notes.push_back(note.value_or(std::string()));
    const toml::array* designs = (*node)["designs"].as_array();
    if (designs == nullptr) continue;
    stage.complete = (*node)["complete"].value_or(false);
    for (const toml::node& item : *designs) {
      Design values;
      if (const toml::table* table = item.as_table())
        for (const auto& [key, value] : *table) values.emplace_back(std::string(key.str()), value.value_or(not_given));
      add_design(plan, study, s, std::move(values));
    }
  }
}

}  // namespace drumsweep
