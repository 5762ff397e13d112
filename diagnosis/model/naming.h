/// Which causes explain the data: a name, or a set of names.
///
///  1. Adequate is a model whose Q is below its own bootstrapped 99 % point. Singles first; pairs where no single is adequate, or where
///     pairs hold more than 90 % of the posterior.
///  2. Named is a set: the 95 % credible set of the adequate models (Laplace evidence, effect priors), and whatever lies within 3.84
///     of the best in Q, so that a wrong unique name stays below 2.5 % for rivals at any distance.
///  3. Held-out conditions, never used so far, refuse members that predict them badly (p < 0.01). A set in which every member would
///     have to be stronger than its range allows is refused as a whole.
#pragma once

#include "diagnosis/model/held_out.h"
#include "diagnosis/model/misfit.h"

namespace drumsweep {

struct NamedEffect {
  int effect;
  double strength, low, high;  ///< with the 95 % interval, in the effect's unit
};

/// One model that can explain the data.
struct Explanation {
  std::vector<NamedEffect> effects;
  double q, weight;  ///< weight: posterior among adequate models
  double held_out_p = std::nan("");
  double held_out_nats = std::nan("");
  ModelFit fit;
};

struct Naming {
  std::vector<Explanation> causes;   ///< the set, best first; empty unless something is wrong and explained
  std::vector<Explanation> refused;  ///< adequate, but not on the held-out conditions, or only at the end of its range

  std::vector<ModelFit> leading;  ///< best of all models by their evidence, adequate or not

  /// Whether this unordered set of effects is among the causes.
  bool names(const std::vector<int>& effects) const;
};
Naming name_causes(const Inquiry& inquiry, const Misfit& misfit);

}  // namespace drumsweep
