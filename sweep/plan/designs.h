/// From a study's stages to a list of designs, each once.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/config/study.h"
#include "core/scene/drum.h"

namespace drumsweep {

/// One point of design space that the study asks for.
struct PlannedDesign {
  std::string id;                ///< 10 hex digits, see design_id()
  std::string stage;             ///< the first stage in which it occurs
  Design values;                 ///< what differs from the study, keys in alphabetical order
  std::vector<double> row;       ///< (num_columns) values of all columns; the study's own where no stage sets them
  std::string impossible;        ///< why there is no such drum (slots overlap ...), empty when there is one
  std::size_t stage_number = 0;  ///< of `stage`, from 0
};

/// What a stage has asked for so far.
struct StageSummary {
  std::string name, type;
  std::size_t nodes = 0;             ///< in the stage
  std::size_t shared = 0;            ///< of these, already part of an earlier stage (or twice in this one)
  std::size_t impossible = 0;        ///< of these, without a geometry; holes in the surface
  bool complete = false;             ///< no results will make it ask for more
  std::vector<std::string> notes;    ///< what it has decided from results and why, a sentence each
  std::vector<std::size_t> designs;  ///< (nodes) in Plan::designs
};

struct Plan {
  std::vector<std::string> keys;     ///< design variables: the union over the stages, in order of appearance
  std::vector<std::string> columns;  ///< their names in tables: "outlet.base_width_m" -> "base_width_m"
  /// Stages of type grid and points first, then what searches have asked for. Only ever grows at its end, so an index
  /// stays what it is; for tables see table_order().
  std::vector<PlannedDesign> designs;
  std::vector<StageSummary> stages;
  std::unordered_map<std::string, std::size_t> index_of_id;  ///< into designs
};

/// Stages in order; grid: all combinations of evenly spaced values, first variable slowest; points: the i-th values
/// together. Values are rounded(), so that stages which overlap share their results although their steps are
/// computed differently. A design that occurs again is simulated once and belongs to the first stage.
/// An impossible geometry is a hole in the surface, no error: the ranges of S1 contain overlapping slots.
/// Searches are there, without designs: what they ask for depends on results, see planner.h.
/// @throws InputError when two different designs have the same id (odds below 1e-6 for a thousand designs).
Plan plan_designs(const Study& study);

/// Adds a design to a stage, and to the plan if it is new there. @return its index in the plan, and whether it was new
std::pair<std::size_t, bool> add_design(Plan& plan, const Study& study, std::size_t stage, Design values);

/// Indices into plan.designs: by stage, then by the columns' values.
std::vector<std::size_t> table_order(const Plan& plan);

/// Keys by which searches repeat a design with other random numbers, or for longer.
inline constexpr const char *replicate_key = "record.replicate", *turns_key = "record.turns";

/// Design values are whole multiples of 1/1e9 of their key's unit: 1 nm, 1e-9 deg. Far below what can be built.
inline constexpr double design_steps_per_unit = 1e9;

/// Rounds to such a multiple: the double nearest to the decimal number.
double rounded(double value);

/// All nodes of a stage of type grid or points, values in the order of its variables; the ends of a range are met exactly.
std::vector<Design> nodes_of_stage(const StageConfig& stage);

/// Hash of the text "key=value;key=value;" with alphabetical keys and shortest exact values: of the content, not of the
/// position, so ids stay when stages are added, removed or refined.
std::string design_id(const Design& values);

/// "opening_angle_deg = 0.2, base_width_m = 0.044", in the order of the columns.
std::string describe(const Plan& plan, const PlannedDesign& design);

}  // namespace drumsweep
