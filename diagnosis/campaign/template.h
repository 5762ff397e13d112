/// The files that `drumsweep diagnose --template` writes: schedules/campaign, compiled in.
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

struct TemplateText {
  const char* name;  ///< without its ending
  const char* text;
};
extern const TemplateText embedded_template[];
extern const int num_embedded_template;

struct TemplateFile {
  std::string name, text;
};
inline std::vector<TemplateFile> template_files() {
  std::vector<TemplateFile> list;
  for (int i = 0; i < num_embedded_template; ++i) {
    const std::string name = embedded_template[i].name;
    list.push_back({name + (name == "measured" ? ".csv" : ".toml"), embedded_template[i].text});
  }
  return list;
}

}  // namespace drumsweep
