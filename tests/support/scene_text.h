/// Scenes from text, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/config/schema.h"
#include "core/scene/scene_value.h"
#include "support/complaint.h"

namespace drumsweep {

inline SceneResult run_scene(const std::string& text) {
  const SceneFile file = parse_scene(text, "scene.toml");
  return file.scene->run(file.physics, {});
}

/// The observable's value; a failure where it is missing.
inline double value(const SceneResult& result, const std::string& name) {
  for (const Observable& o : result.observables)
    if (o.name == name) return o.value;
  ADD_FAILURE() << name << " is missing";
  return std::nan("");
}

/// What is wrong with the text; empty where nothing is.
inline std::string scene_error(const std::string& text) {
  return complaint([&] { parse_scene(text, "scene.toml"); });
}

}  // namespace drumsweep
