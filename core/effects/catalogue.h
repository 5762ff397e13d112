/// The effects that the plain model leaves out, by name: what is switched on and off when measured data disagree with it.
///
/// To add a sibling: its keys in EffectsConfig and add_physics_fields(), its physics in a file of this folder, called where the
/// others are (step/assemble.cc for contacts, step/stepper.cc for free flight, geometry for walls, step/feed.cc for balls), and a
/// line in the list here. Neutral must mean bit for bit the plain model; tests/core/effects/catalogue_test.cc checks all.
#pragma once

#include <span>

namespace drumsweep {

struct Effect {
  const char* id;
  const char* key;    ///< its strength, a numeric key of study and scene files
  const char* unit;   ///< "1" for a number
  double neutral;     ///< value of the key at which the effect is off
  double large;       ///< a strength at the upper end of what occurs, for screening
  const char* about;  ///< one line
};

std::span<const Effect> effect_catalogue();

}  // namespace drumsweep
