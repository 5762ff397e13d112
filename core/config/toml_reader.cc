#include "core/config/toml_reader.h"

#include <fmt/format.h>

#include <cctype>

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
  const std::size_t equals = change.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == change.size())
    throw InputError(fmt::format("{}: needs KEY=VALUE", source));
  const std::string value = change.substr(equals + 1);
  const bool word = std::isalpha(static_cast<unsigned char>(value[0])) != 0 && value != "true" && value != "false" &&
                    value != "nan" && value != "inf";
  const std::string text = word ? toml_text(value) : value;
  return parse_study(fmt::format("{} = {}", change.substr(0, equals), text), source, study);
}

Study read_study(const std::string& path) { return parse_study(read_text(path), path); }

std::string write_study(const Study& study, bool comments) {
  Study copy = study;
  std::string out = write_fields(fields(copy), comments);
  for (const StageConfig& stage : study.stages) out += write_stage(stage);
  return out;
}

}  // namespace drumsweep
