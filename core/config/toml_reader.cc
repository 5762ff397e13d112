#include "core/config/toml_reader.h"

#include <fmt/format.h>

#include <limits>
#include <vector>

#include "core/config/schema.h"
#include "core/config/stages.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
namespace {

Study study_from(const toml::table& root, const std::string& source, const Study& base) {
  Study study = base;
  FieldReader reader{source, fields(study), "stage", {}};
  reader.table(root, "");
  if (const toml::node* node = root.get("stage")) {
    const toml::array* stages = node->as_array();
    if (stages == nullptr)
      throw InputError(place(source, node->source()) + "stage: needs to be a list of tables, [[stage]]");
    for (const toml::node& item : *stages) {
      if (!item.is_table())
        throw InputError(place(source, item.source()) + "stage: needs to be a list of tables, [[stage]]");
      study.stages.push_back(read_stage(*item.as_table(), source));
    }
  }
  validate(study, reader.where());
  return study;
}

/// A value that designs replace would be taken for granted and have no effect.
void refuse_variables(const Study& study, const toml::table& changes, const std::string& source) {
  for (const StageConfig& stage : study.stages)
    for (const StageVariable& v : stage.variables)
      if (changes.at_path(v.key))
        throw InputError(fmt::format("{}: {} is a variable of the study's stages, each design has its own{}", source,
                                     v.key,
                                     v.key.starts_with("outlet.") ? "; the outlet of the warm-up is [warmup]" : ""));
}

}  // namespace

Study parse_study(const std::string& text, const std::string& source, const Study& base) {
  return study_from(parse_toml(text, source), source, base);
}

Study changed_study(const Study& study, const std::vector<std::string>& changes, const std::string& source) {
  const toml::table root = changes_as_toml(changes, source);
  if (root.contains("stage")) throw InputError(source + ": stages can be changed in the file only");
  refuse_variables(study, root, source);
  Study base = study;
  const auto other_unit = [&](const char* table, double& deg, double& rad) {
    const bool to_deg = static_cast<bool>(root[table]["opening_angle_deg"]),
               to_rad = static_cast<bool>(root[table]["opening_angle_rad"]);
    if (to_deg != to_rad) (to_deg ? rad : deg) = std::numeric_limits<double>::quiet_NaN();
  };
  other_unit("outlet", base.outlet.opening_angle_deg, base.outlet.opening_angle_rad);
  other_unit("warmup", base.warmup.opening_angle_deg, base.warmup.opening_angle_rad);
  return study_from(root, source, base);
}

Study read_study(const std::string& path, const std::vector<std::string>& changes) {
  const Study study = parse_study(read_text(path), path);
  return changes.empty() ? study : changed_study(study, changes, "--set");
}

std::string write_study(const Study& study, bool comments) {
  Study copy = study;
  std::string out = write_fields(fields(copy), comments);
  for (const StageConfig& stage : study.stages) out += write_stage(stage);
  return out;
}

}  // namespace drumsweep
