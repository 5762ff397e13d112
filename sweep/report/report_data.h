/// What the sections of a report draw from.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "postproc/objective.h"
#include "sweep/plan/findings.h"
#include "sweep/status.h"

namespace drumsweep {

/// The best that is known, by the strongest evidence there is.
struct Answer {
  enum class Kind {
    none,        ///< no design has a value
    single_run,  ///< the lowest f of one run
    fit,         ///< the optimum of a fit through all runs
    confirmed    ///< fresh runs at that optimum
  } kind = Kind::none;
  std::vector<std::pair<std::string, double>> at;    ///< column name and value
  std::vector<std::pair<double, double>> region_95;  ///< (num_variables) low and high; empty without a usable fit
  double f_m = 0, sigma_m = 0;
  int num_runs = 0;                      ///< of the fit, or the fresh ones
  std::optional<double> max_an_over_a0;  ///< of what was simulated there; none for a fit
  bool untrusted = false;
};

/// A design with everything between its landings and f.
struct DetailedDesign {
  ResultRow row;
  Study study;  ///< with the design's values
  Recording recording;
  Evaluation evaluation;
};

struct ReportData {
  std::string folder;
  OutputPaths paths;
  Study study;
  Plan plan;
  SweepStatus status;
  ResultTable table;                    ///< what has ended, in the order of results.csv
  std::vector<std::size_t> run_number;  ///< (num_rows) when it was begun first, from 1; 0: never simulated
  std::vector<ProvenanceLine> provenance;
  std::optional<WarmState> warm;
  std::string warm_trouble;  ///< why there is no warm drum to show
  std::optional<Findings> findings;
  Answer answer;
  std::optional<DetailedDesign> best;                           ///< the simulated design nearest to the answer
  std::vector<std::pair<std::string, DetailedDesign>> samples;  ///< S1's sample points, with their names
  std::vector<std::pair<std::string, std::string>>
      unreadable;  ///< designs whose landings were wanted here, and why not
  std::vector<std::string> notes;
};

ReportData gather_report(const std::string& folder);

}  // namespace drumsweep
