/// One condition of a campaign: a scene or a study with its known inputs, simulated with changed numbers.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/observable.h"

namespace drumsweep {

/// One number of the input changed. Where a file has no such key nothing happens.
struct KeyChange {
  enum class How {
    set,
    add,
    scale,
    below
  } how;  ///< value; old + value; old (1 + value); (1 - value) times the number at `of`
  std::string key;
  double value;
  std::string of{};  ///< below: e.g. dynamic friction below material.friction
};

/// Halves the time step and quadruples the iterations: what is left of the numerical error shows in the difference.
struct Finer {
  bool on = false;
};

struct ConditionResult {
  std::vector<Observable> observables;
  std::uint64_t state_hash = 0;
  double cpu_s = 0;
  bool stopped = false;
};

struct Condition {
  std::string id, path;
  std::string text;  ///< of the scene or study file, known inputs put in: all that a rank needs
  bool is_scene = true;
  std::string type;   ///< "pile", "drum" ..., "study"
  std::string group;  ///< of its quantities where they do not say themselves; bench | drum | outlet | belt | mass
  bool held_out = false;
  double cost = std::numeric_limits<double>::quiet_NaN();  ///< of measuring it once, in any unit
  /// What another program has simulated for these quantities: outputs are scaled so that the plain model at the prior's mean gives it.
  std::vector<std::pair<std::string, double>> baseline{};

  /// Whether the file has this numeric key.
  bool has(const std::string& key) const;
  /// @throws InputError: a number out of its range, or what the scene cannot do
  void check(const std::vector<KeyChange>& changes) const;
  /// @param go_on  asked after every outer step; the run stops where it says no
  ConditionResult simulate(std::int64_t seed, const std::vector<KeyChange>& changes, Finer finer, int threads,
                           const std::function<bool()>& go_on) const;
};

/// Reads the file and puts `inputs` in. @throws InputError
Condition read_condition(const std::string& id, const std::string& path, const std::vector<KeyChange>& inputs);

/// The text of a study with these changes, stages and all. @throws InputError
std::string extended_text(const Condition& study, const std::vector<KeyChange>& changes);

/// bench | drum | outlet | belt | mass, by what the quantity is about.
std::string group_of(const Condition& condition, const std::string& quantity);

}  // namespace drumsweep
