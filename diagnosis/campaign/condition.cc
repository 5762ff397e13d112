#include "diagnosis/campaign/condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/config/field_table.h"
#include "core/config/toml_fields.h"
#include "core/config/toml_reader.h"
#include "core/scene/cpu_clock.h"
#include "core/scene/scene.h"
#include "sweep/single_design.h"

namespace drumsweep {
namespace {

/// A scene or a study with its keys listed.
struct Input {
  SceneFile scene;
  Study study;
  bool is_scene;
  std::vector<Field> list;

  explicit Input(const Condition& c, bool with_stages = false) : is_scene(c.is_scene) {
    if (is_scene) {
      scene = parse_scene(c.text, c.path);
      FieldTable table{list, "scene.", Scope::warm_state};
      scene.scene->add_fields(table);
      add_physics_fields(scene.physics, list);
    } else {
      study = parse_study(c.text, c.path);
      if (!with_stages) study.stages.clear();
      list = fields(study);
    }
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  Physics& physics() { return is_scene ? scene.physics : study; }
  double* number(const std::string& key) {
    for (Field& f : list)
      if (f.key == key)
        if (auto** value = std::get_if<double*>(&f.value)) return *value;
    return nullptr;
  }
  void change(const KeyChange& c) {
    // Nothing is touched by a change of nothing, so that an effect that is off leaves the plain model bit for bit.
    if (c.how != KeyChange::How::set && c.value == 0) return;
    double* target = number(c.key);
    if (target == nullptr) return;
    switch (c.how) {
      case KeyChange::How::set:
        *target = c.value;
        return;
      case KeyChange::How::add:
        *target += c.value;
        return;
      case KeyChange::How::scale:
        *target *= 1 + c.value;
        return;
      case KeyChange::How::below:
        if (const double* of = number(c.of)) *target = *of * (1 - c.value);
    }
  }
  void change_all(const std::vector<KeyChange>& changes) {
    for (const KeyChange& c : changes) change(c);
  }
  void check(const std::string& path) {
    const Where where = [&](const std::string&) { return path + ": "; };
    validate_values(list, where);
    if (!is_scene) return validate(study, where);
    validate_physics(scene.physics, where);
    scene.scene->validate(scene.physics, where);
  }
  std::string text() { return is_scene ? write_scene(scene, false) : write_study(study, false); }
};

}  // namespace

Condition read_condition(const std::string& id, const std::string& path, const std::vector<KeyChange>& inputs) {
  Condition c;
  c.id = id;
  c.path = path;
  c.text = read_text(path);
  c.is_scene = is_scene_file(path);
  Input input(c);
  for (const KeyChange& change : inputs) {
    if (input.number(change.key) == nullptr) {
      std::vector<std::string> keys;
      for (const Field& f : input.list)
        if (std::holds_alternative<double*>(f.value)) keys.push_back(f.key);
      const std::string near = did_you_mean(change.key, keys);
      throw InputError(fmt::format("condition {}: {} has no numeric key {}{}", id, path, change.key,
                                   near.empty() ? "" : "; did you mean " + near + "?"));
    }
    input.change(change);
  }
  input.check(fmt::format("condition {} ({})", id, path));
  c.type = c.is_scene ? input.scene.type : "study";
  c.group = c.type == "drum"       ? "drum"
            : c.type == "slot"     ? "outlet"
            : c.type == "conveyor" ? "belt"
            : c.type == "study"    ? "belt"
                                   : "bench";
  c.text = input.text();
  return c;
}

bool Condition::has(const std::string& key) const { return Input(*this).number(key) != nullptr; }

void Condition::check(const std::vector<KeyChange>& changes) const {
  Input input(*this);
  input.change_all(changes);
  input.check(fmt::format("condition {} ({})", id, path));
}

ConditionResult Condition::simulate(std::int64_t seed, const std::vector<KeyChange>& changes, Finer finer, int threads,
                                    const std::function<bool()>& go_on) const {
  Input input(*this);
  input.change_all(changes);
  Physics& physics = input.physics();
  physics.seed = seed;
  if (finer.on) {
    physics.solver.sub_steps *= 2;
    if (physics.solver.iterations > 0) physics.solver.iterations *= 4;
  }
  input.check(fmt::format("condition {} ({})", id, path));
  ConditionResult out;
  if (is_scene) {
    input.scene.scene->threads = threads;
    SceneResult r = input.scene.scene->run(physics, [&](const SceneProgress&) { return go_on(); });
    out.stopped = r.stopped;
    out.state_hash = state_hash(r.state);
    out.observables = std::move(r.observables);
    out.cpu_s = r.cpu_s;
    return out;
  }
  const double begin = cpu_seconds_of_run(threads);
  const Observer observer = [&](const Progress&) { return go_on(); };
  WarmState warm;
  out.stopped = !warm_up(input.study, warm, observer, {}, threads);
  if (!out.stopped) {
    const Recording recording = run_design(input.study, warm.state, {}, observer, threads);
    out.stopped = recording.stopped;
    out.state_hash = recording.hash;
    if (!out.stopped) out.observables = observables(input.study, {}, recording);
  }
  out.cpu_s = cpu_seconds_of_run(threads) - begin;
  return out;
}

std::string extended_text(const Condition& study, const std::vector<KeyChange>& changes) {
  Input input(study, true);
  input.change_all(changes);
  input.check(study.path);
  return input.text();
}

std::string group_of(const Condition& condition, const std::string& quantity) {
  const auto about = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(),
                       [&](const char* w) { return quantity.find(w) != std::string::npos; });
  };
  if (condition.group == "bench") return "bench";
  if (about({"holdup", "residence", "axial", "outflow_over_feed", "released"})) return "mass";
  if (about({"outflow_share", "discharge"})) return "outlet";
  if (about({"bed_", "mean_height", "surface_height", "f_belt", "f_footprint"}) || quantity == "f") return "belt";
  return condition.group;
}

}  // namespace drumsweep
