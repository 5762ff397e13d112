/// The plan of a study whose later stages decide from the results of earlier ones. A pure function of study and
/// results: the same for any number of ranks, any order in which results come, and any interruption; nothing but the
/// designs' results has to be stored.
///
///   zoom       a grid around the optimum of the fit through all earlier results
///   adaptive   designs spread evenly, then batches where the fit says that simulating gains most
///   refine     NLopt, several starts side by side, if the fit says that the surface is smooth enough; otherwise the
///              optimum of the fit
///   replicate  the optimum of the fit, and the best designs, simulated again with other random numbers
///
/// A stage begins when every design of all earlier stages has ended. Failed and untrusted designs are holes: no search
/// ever sees a value for them. Results are used where they lie in the stage's ranges and agree with the study in every
/// key that the stage does not search; replicates of one design count as one sample.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/fit/box.h"
#include "sweep/fit/gate.h"
#include "sweep/fit/samples.h"
#include "sweep/fit/surface.h"
#include "sweep/plan/designs.h"

namespace drumsweep {

/// The row of a design that has ended; null while it has not.
using RowOf = std::function<const ResultRow*(const PlannedDesign&)>;

class Planner {
 public:
  explicit Planner(const Study& study);
  ~Planner();

  const Plan& plan() const { return plan_; }

  /// Adds what searches ask for now. @return true when designs were added or a stage was completed
  bool extend(const RowOf& row_of);

  /// No results will add designs.
  bool complete() const;

 private:
  struct Search;

  Study study_;
  Plan plan_;
  std::vector<std::unique_ptr<Search>> searches_;  ///< (num_stages) what a search has found out once and for all
};

/// How many designs a stage that is not complete may still ask for, at most.
std::size_t most_further_designs(const Study& study, const Plan& plan, std::size_t stage);

/// Ranges of a search as a box.
Box search_box(const Study& study, std::size_t stage);

/// The point of the box that a design stands for; nothing where it lies outside, or differs from the study in a key that
/// is neither searched nor one of [record].
std::optional<Point> point_of(const Box& box, const Study& study, const Plan& plan, const PlannedDesign& design);

/// Results of the stages before `end`, and of what else has ended of stage `end` - 1, that lie in the box.
std::vector<Measurement> measurements_in(const Box& box, const Study& study, const Plan& plan, std::size_t end,
                                         const RowOf& row_of);

/// The fit through such results, and what the gate says about it. Of more than some hundred rows, those of the points
/// with the lowest f are fitted: the cost grows with the cube, and the optimum is there.
struct Fit {
  std::vector<Sample> points;            ///< that are fitted
  SharedNoise noise;                     ///< of all
  std::optional<FittedSurface> surface;  ///< none where there are too few points
  Gate gate;
};
Fit fit_rows(const Box& box, const Study& study, const Plan& plan, std::size_t end, const RowOf& row_of);

}  // namespace drumsweep
