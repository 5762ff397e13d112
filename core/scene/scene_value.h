/// Looking up what a scene found.
#pragma once

#include <cmath>
#include <string>

#include "core/scene/scene.h"

namespace drumsweep {

/// The observable of this name, NaN with NaN error where there is none.
inline Estimate scene_value(const SceneResult& result, const std::string& name) {
  for (const Observable& o : result.observables)
    if (o.name == name) return {o.value, o.sigma};
  return {std::nan(""), std::nan("")};
}

/// Its value alone.
inline double observed(const SceneResult& result, const std::string& name) { return scene_value(result, name).mean; }

/// One column of the series of this name, empty where there is none.
inline std::vector<double> scene_column(const SceneResult& result, const std::string& name, std::size_t column) {
  std::vector<double> out;
  for (const Series& s : result.series)
    if (s.name == name)
      for (std::size_t i = column; i < s.values.size(); i += s.columns.size()) out.push_back(s.values[i]);
  return out;
}

}  // namespace drumsweep
