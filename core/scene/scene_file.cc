#include <fmt/format.h>

#include <algorithm>

#include "core/config/toml_fields.h"
#include "core/scene/collapse.h"
#include "core/scene/conveyor.h"
#include "core/scene/drop.h"
#include "core/scene/incline.h"
#include "core/scene/packing.h"
#include "core/scene/pile.h"
#include "core/scene/rotating_drum.h"
#include "core/scene/scene.h"
#include "core/scene/slot.h"

namespace drumsweep {
namespace {

template <class T>
std::unique_ptr<Scene> make() {
  return std::make_unique<T>();
}

constexpr SceneType all_types[] = {
    {"drop", "one ball meets a plate, straight or obliquely: restitution, spin", make<DropScene>},
    {"incline", "one ball or a small stack on a tilted plane: rest, rolling, decay of spin", make<InclineScene>},
    {"packing", "balls settle in a box: packing fraction, coordination, forces on the walls", make<PackingScene>},
    {"conveyor", "balls fall on a moving belt: profile, height and slope of the bed", make<ConveyorScene>},
    {"collapse", "a column of balls collapses when its gate opens: run-out, height", make<CollapseScene>},
    {"pile", "a heap of poured balls, or out of a lifted cylinder: angle of repose, packing", make<PileScene>},
    {"slot", "a silo empties through a slot or a round orifice: discharge rate, bulk density", make<SlotScene>},
    {"drum", "rotating drum: periodic slice, with end walls, or inclined and fed", make<RotatingDrumScene>},
};

/// Every key of a scene file, in its order.
std::vector<Field> scene_fields(SceneFile& file) {
  std::vector<Field> list;
  FieldTable top{list, ""};
  top.text("name", file.name, {}, "title in figures and reports");
  top.scope = Scope::warm_state;
  top.count("seed", file.physics.seed, 0, 9007199254740992.0, "of places, sizes and textures");
  FieldTable scene{list, "scene.", Scope::warm_state};
  std::vector<std::string> names;
  for (const SceneType& t : scene_types()) names.emplace_back(t.name);
  scene.text("type", file.type, names, "which experiment");
  if (file.scene) file.scene->add_fields(scene);
  add_physics_fields(file.physics, list);
  return list;
}

void read_keys(const toml::table& root, const std::string& source, SceneFile& file) {
  FieldReader reader{source, scene_fields(file), "", {}};
  reader.table(root, "");
  validate_values(reader.known, reader.where());
  validate_physics(file.physics, reader.where());
  file.scene->validate(file.physics, reader.where());
}

}  // namespace

std::span<const SceneType> scene_types() { return all_types; }

bool is_scene_file(const std::string& path) { return parse_toml(read_text(path), path).get("scene") != nullptr; }

SceneFile read_scene(const std::string& path, const std::vector<std::string>& changes) {
  SceneFile file = parse_scene(read_text(path), path);
  if (changes.empty()) return file;
  const toml::table root = changes_as_toml(changes, "--set");
  if (root["scene"]["type"]) throw InputError("--set scene.type: another scene has other keys; write a file for it");
  read_keys(root, "--set", file);
  return file;
}

SceneFile parse_scene(const std::string& text, const std::string& source) {
  const toml::table root = parse_toml(text, source);
  SceneFile file;
  const toml::node_view type = root["scene"]["type"];
  if (!type.is_string()) throw InputError(source + ": [scene] needs type = \"...\"");
  file.type = type.as_string()->get();
  file.name = file.type;
  const auto found =
      std::find_if(scene_types().begin(), scene_types().end(), [&](const SceneType& t) { return t.name == file.type; });
  if (found == scene_types().end()) {
    std::vector<std::string> names;
    for (const SceneType& t : scene_types()) names.emplace_back(t.name);
    const std::string near = did_you_mean(file.type, names);
    throw InputError(fmt::format("{}scene.type = \"{}\": accepted is {}{}", place(source, type.node()->source()),
                                 file.type, fmt::join(names, " | "),
                                 near.empty() ? "" : "; did you mean " + near + "?"));
  }
  file.scene = found->make();
  read_keys(root, source, file);
  return file;
}

std::string write_scene(SceneFile& file, bool comments) { return write_fields(scene_fields(file), comments); }

}  // namespace drumsweep
