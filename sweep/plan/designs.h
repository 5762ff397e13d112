/// From a study's stages to a list of designs, each once, in the order of the result table. A pure function of the
/// study.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/config/study.h"
#include "core/scene/drum.h"

namespace drumsweep {

/// One point of design space that the study asks for.
struct PlannedDesign {
  std::string id;           ///< 10 hex digits, see design_id()
  std::string stage;        ///< the first stage in which it occurs
  Design values;            ///< what differs from the study, keys in alphabetical order
  std::vector<double> row;  ///< (num_columns) values of all columns; the study's own where no stage sets them
  std::string impossible;   ///< why there is no such drum (slots overlap ...), empty when there is one
};

/// How many nodes a stage has, for people.
struct StageSummary {
  std::string name;
  std::size_t nodes = 0;       ///< in the stage
  std::size_t shared = 0;      ///< of these, already part of an earlier stage (or twice in this one)
  std::size_t impossible = 0;  ///< of these, without a geometry; holes in the surface
};

struct Plan {
  std::vector<std::string> keys;       ///< design variables: the union over the stages, in order of appearance
  std::vector<std::string> columns;    ///< their names in tables: "outlet.base_width_m" -> "base_width_m"
  std::vector<PlannedDesign> designs;  ///< sorted by stage, then by the columns' values
  std::vector<StageSummary> stages;
};

/// Stages in order; grid: all combinations of evenly spaced values, first variable slowest; points: the i-th values
/// together. Values are rounded(), so that stages which overlap share their results although their steps are
/// computed differently. A design that occurs again is simulated once and belongs to the first stage.
/// An impossible geometry is a hole in the surface, no error: the ranges of S1 contain overlapping slots.
/// @throws InputError when two different designs have the same id (odds below 1e-6 for a thousand designs).
Plan plan_designs(const Study& study);

/// Design values are whole multiples of 1/1e9 of their key's unit: 1 nm, 1e-9 deg. Far below what can be built.
inline constexpr double design_steps_per_unit = 1e9;

/// Rounds to such a multiple: the double nearest to the decimal number.
double rounded(double value);

/// Hash of the text "key=value;key=value;" with alphabetical keys and shortest exact values: of the content, not of the
/// position, so ids stay when stages are added, removed or refined.
std::string design_id(const Design& values);

/// "opening_angle_deg = 0.2, base_width_m = 0.044", in the order of the columns.
std::string describe(const Plan& plan, const PlannedDesign& design);

}  // namespace drumsweep
