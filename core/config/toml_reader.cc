#include "core/config/toml_reader.h"

#include <vector>

#include "core/config/schema.h"
#include "core/config/stages.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
Study parse_study(const std::string& text, const std::string& source, const Study& base) {
  const toml::table root = parse_toml(text, source);
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

Study changed_study(const Study& study, const std::string& change, const std::string& source) {
  return parse_study(change_as_toml(change, source), source, study);
}

Study read_study(const std::string& path, const std::vector<std::string>& changes) {
  Study study = parse_study(read_text(path), path);
  for (const std::string& change : changes) study = changed_study(study, change, "--set " + change);
  return study;
}

std::string write_study(const Study& study, bool comments) {
  Study copy = study;
  std::string out = write_fields(fields(copy), comments);
  for (const StageConfig& stage : study.stages) out += write_stage(stage);
  return out;
}

}  // namespace drumsweep
