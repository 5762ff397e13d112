#include "diagnosis/model/naming.h"

#include <set>

#include "diagnosis/model/outlook.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double twin_rise = 9;  // in Q: what the emulator's error may make between equal effects
constexpr double credible = 0.95;
constexpr double pairs_needed = 0.9;
constexpr double pairs_prior = 0.3;  // prior weight of all pairs together
constexpr double worse_nats = -3, clearly_worse = 3;
constexpr double worth_a_bootstrap = 8;  // in log evidence below the best
constexpr std::size_t num_leading = 3;
constexpr double nothing = 1e-3;  // a strength, as part of its range

struct Contender {
  SubModel model;
  Eigen::VectorXd z;  ///< what was measured, in the model's coordinates
  ModelFit fit;
  double log_weight = 0;
  bool adequate = false;
};

/// Of one model with so many effects.
double log_prior(const Inquiry& in, std::size_t num_effects) {
  const double n = in.num_effects;
  return num_effects == 1 ? std::log((1 - pairs_prior) / n) : std::log(pairs_prior / (0.5 * n * (n - 1)));
}

/// The least strength of the fit, as part of its range.
double least_strength(const Contender& c) {
  return c.fit.x.tail(static_cast<Index>(c.fit.effects.size())).cwiseAbs().minCoeff();
}

Contender contender(const Inquiry& in, const std::vector<int>& effects) {
  Contender c;
  c.model = in.model(effects);
  c.z = in.seen_by(c.model);
  c.fit = fit_model(c.model, c.z, in.centre, true);
  c.log_weight = log_evidence(c.fit, c.model, in.problem) + log_prior(in, effects.size());
  return c;
}

std::vector<Contender> all_singles(const Inquiry& in) {
  std::vector<Contender> list;
  for (int k = 0; k < in.num_effects; ++k)
    if (in.listed(k)) list.push_back(contender(in, {k}));
  return list;
}
std::vector<Contender> all_pairs(const Inquiry& in) {
  std::vector<Contender> list;
  for (int a = 0; a < in.num_effects; ++a)
    for (int b = a + 1; b < in.num_effects; ++b) {
      if (!in.listed(a) || !in.listed(b)) continue;
      Contender pair = contender(in, {a, b});
      // A pair with one of its strengths at nothing is the single again.
      if (least_strength(pair) >= nothing) list.push_back(std::move(pair));
    }
  return list;
}

bool is_adequate(const Inquiry& in, const Contender& c) {
  std::vector<double> draws;
  for (int b = 0; b < in.options.adequate_bootstraps; ++b) {
    const Inquiry::Drawn drawn = in.draw(c.model, c.fit, 1'000'000 + static_cast<std::uint64_t>(b));
    draws.push_back(fit_from(c.model, drawn.z, drawn.centre, c.fit.x).q);
  }
  std::sort(draws.begin(), draws.end());
  return c.fit.q <= draws[static_cast<std::size_t>(in.options.adequate_level * static_cast<double>(draws.size() - 1))];
}

/// Finds the adequate ones. @return whether there is any
bool find_adequate(const Inquiry& in, std::vector<Contender>& list) {
  if (list.empty()) return false;
  // The evidence decides who is worth a bootstrap.
  const auto less_q = [](const Contender& a, const Contender& b) { return a.fit.q < b.fit.q; };
  const auto less_weight = [](const Contender& a, const Contender& b) { return a.log_weight < b.log_weight; };
  const Contender& nearest = *std::min_element(list.begin(), list.end(), less_q);
  const double best = std::max_element(list.begin(), list.end(), less_weight)->log_weight;
  bool any = false;
  for (Contender& c : list) {
    const bool in_reach = c.log_weight > best - worth_a_bootstrap || c.fit.q < nearest.fit.q + rival_rise;
    c.adequate = in_reach && is_adequate(in, c);
    any = any || c.adequate;
  }
  return any;
}

/// Part of the posterior that pairs hold, against the adequate singles.
double part_of_pairs(const std::vector<Contender>& singles, const std::vector<Contender>& pairs) {
  double of_singles = 0, of_pairs = 0, most = -infinity;
  for (const auto* list : {&singles, &pairs})
    for (const Contender& c : *list) most = std::max(most, c.log_weight);
  for (const Contender& c : singles) of_singles += c.adequate ? std::exp(c.log_weight - most) : 0;
  for (const Contender& c : pairs) of_pairs += std::exp(c.log_weight - most);
  return of_pairs / (of_pairs + of_singles);
}

std::vector<ModelFit> leading_of(const std::vector<Contender>& singles, const std::vector<Contender>& pairs) {
  std::vector<const Contender*> all;
  for (const auto* list : {&singles, &pairs})
    for (const Contender& c : *list) all.push_back(&c);
  std::stable_sort(all.begin(), all.end(),
                   [](const Contender* a, const Contender* b) { return a->log_weight > b->log_weight; });
  std::vector<ModelFit> out;
  for (std::size_t i = 0; i < std::min(num_leading, all.size()); ++i) out.push_back(all[i]->fit);
  return out;
}

Explanation explanation(const Inquiry& in, const Misfit& misfit, const Contender& c, double weight) {
  Explanation e;
  e.fit = c.fit;
  e.q = c.fit.q;
  e.weight = weight;
  for (std::size_t k = 0; k < c.fit.effects.size(); ++k) {
    const CandidateEffect& effect = in.problem.effects[static_cast<std::size_t>(c.fit.effects[k])];
    const Interval interval = profile_interval(c.model, c.z, in.centre, c.fit, k);
    e.effects.push_back({c.fit.effects[k], effect.strength(c.fit.x[c.model.num_parameters + static_cast<Index>(k)]),
                         effect.strength(interval.low), effect.strength(interval.high)});
  }
  const HeldOutJudgement judgement = judge_held_out(in, misfit.plain, c.fit);
  e.held_out_p = judgement.p;
  e.held_out_nats = judgement.nats;
  return e;
}

/// Leaves the adequate ones, best first: as near to the data as an adequate one is adequate, on whichever side of its own 99 % point it lies.
void keep_adequate(std::vector<Contender>& list) {
  double adequate_q = infinity;
  for (const Contender& c : list)
    if (c.adequate) adequate_q = std::min(adequate_q, c.fit.q);
  std::erase_if(list, [&](const Contender& c) { return !c.adequate && c.fit.q > adequate_q + rival_rise; });
  std::sort(list.begin(), list.end(),
            [](const Contender& a, const Contender& b) { return a.log_weight > b.log_weight; });
}

/// Whether c is as good an explanation as the nearest. The campaign's errors are common to both: where it cannot tell them apart, two second
/// waves with errors of their own do so only clearly.
bool is_near(const Inquiry& in, const Contender& c, const Contender& nearest) {
  const double rise = c.fit.q - nearest.fit.q;
  if (rise < rival_rise) return true;
  if (!in.has_second_wave() || rise > twin_rise) return false;
  const auto campaign_q = [&](const std::vector<int>& effects) {
    const SubModel m = in.campaign_model(effects);
    return fit_model(m, in.seen_by(m), in.centre, true).q;
  };
  return campaign_q(c.fit.effects) < campaign_q(nearest.fit.effects) + rival_rise;
}

/// Of all contenders (best first), in units of the first.
double total_weight(const std::vector<Contender>& list) {
  double total = 0;
  for (const Contender& c : list) total += std::exp(c.log_weight - list.front().log_weight);
  return total;
}

/// The credible set, and whoever lies near the best.
std::vector<Explanation> members_of_set(const Inquiry& in, const Misfit& misfit, const std::vector<Contender>& list) {
  const Contender& nearest = *std::min_element(
      list.begin(), list.end(), [](const Contender& a, const Contender& b) { return a.fit.q < b.fit.q; });
  const double total = total_weight(list);
  double reached = 0;
  std::vector<Explanation> members;
  for (const Contender& c : list) {
    const double weight = std::exp(c.log_weight - list.front().log_weight) / total;
    if (reached < credible || is_near(in, c, nearest)) members.push_back(explanation(in, misfit, c, weight));
    reached += weight;
  }
  return members;
}

/// What the held-out conditions say to the members.
Naming refuse(const Inquiry& in, std::vector<Explanation> members) {
  // Who is refused must also do clearly worse than somebody who is not: near twins fall together or not at all.
  const auto fails = [&](const Explanation& e) {
    return !in.options.mutation.skip_held_out && !std::isnan(e.held_out_p) &&
           (e.held_out_p < in.options.held_out_level || e.held_out_nats < worse_nats);
  };
  double kept = -infinity;
  for (const Explanation& e : members)
    if (!fails(e)) kept = std::max(kept, e.held_out_nats);
  Naming out;
  for (Explanation& e : members) {
    const bool refused = fails(e) && e.held_out_nats < kept - clearly_worse;
    const bool alone = std::isinf(kept) && fails(e);
    (refused || alone ? out.refused : out.causes).push_back(std::move(e));
  }
  return out;
}

/// Distance in sigma below which these data, and an emulator of this accuracy, do not tell two models apart.
double twin_distance(const FitSpace& space, double v) {
  double sum = 0;
  for (const double lambda : space.lambda) sum += v * lambda / (1 + v * lambda);
  return std::max(exact_twins, 1.3 * std::sqrt(2 * sum));
}

/// Confounding is declared, not fitted away: whoever cannot be told from a member is a member.
/// @param list  the contenders, best first
void add_twins(const Inquiry& in, const Misfit& misfit, const std::vector<Contender>& list, Naming& out) {
  const double total = total_weight(list);
  double least_q = infinity;
  for (const Explanation& e : out.causes) least_q = std::min(least_q, e.q);
  const std::size_t num_members = out.causes.size();  // a twin's twin is none of the first one's
  for (std::size_t i = 0; i < num_members; ++i)
    for (std::size_t k = 0; k < out.causes[i].fit.effects.size(); ++k)
      for (int j = 0; j < in.num_effects; ++j) {
        const ModelFit fit = out.causes[i].fit;
        std::vector<int> effects = fit.effects;
        if (!in.listed(j) || std::find(effects.begin(), effects.end(), j) != effects.end()) continue;
        effects[k] = j;
        std::sort(effects.begin(), effects.end());
        if (out.names(effects)) continue;
        const SubModel truth = in.campaign_model(fit.effects), rival = in.campaign_model(effects);
        if (distance_to(rival, predict(truth, fit.x), fit.x.head(truth.num_parameters)) >
            twin_distance(*truth.space, fit.v))
          continue;
        const Contender twin = contender(in, effects);
        // Not a twin that has vanished in the fit, nor one that the data hold against all the same.
        if (least_strength(twin) < nothing || twin.fit.q > least_q + twin_rise) continue;
        std::erase_if(out.refused, [&](const Explanation& e) { return e.fit.effects == effects; });
        const double weight = total > 0 ? std::exp(twin.log_weight - list.front().log_weight) / total : 0;
        out.causes.push_back(explanation(in, misfit, twin, weight));
      }
}

bool at_range_end(const Inquiry& in, const ModelFit& fit) {
  const SubModel m = in.campaign_model(fit.effects);
  for (Index i = m.num_parameters; i < fit.x.size(); ++i)
    for (const double end : {m.low[i], m.high[i]})
      if (end != 0 && std::abs(fit.x[i] - end) < nothing) return true;
  return false;
}

/// The set among the adequate ones, and what the held-out conditions say to it.
Naming choose(const Inquiry& in, const Misfit& misfit, std::vector<Contender>& list) {
  keep_adequate(list);
  Naming out = refuse(in, members_of_set(in, misfit, list));
  add_twins(in, misfit, list, out);
  // Where every member would have to be stronger than it can be, none is the cause.
  if (std::all_of(out.causes.begin(), out.causes.end(),
                  [&](const Explanation& e) { return at_range_end(in, e.fit); })) {
    out.refused.insert(out.refused.end(), out.causes.begin(), out.causes.end());
    out.causes.clear();
  }
  return out;
}

}  // namespace

Naming name_causes(const Inquiry& in, const Misfit& misfit) {
  std::vector<Contender> singles = all_singles(in), pairs = all_pairs(in);
  const std::vector<ModelFit> leading = leading_of(singles, pairs);
  const bool singles_do = find_adequate(in, singles);
  const bool pairs_hold = !singles_do || part_of_pairs(singles, pairs) > pairs_needed;
  Naming out;
  if (pairs_hold && find_adequate(in, pairs))
    out = choose(in, misfit, pairs);
  else if (singles_do)
    out = choose(in, misfit, singles);
  out.leading = leading;
  return out;
}

bool Naming::names(const std::vector<int>& effects) const {
  const std::set<int> wanted(effects.begin(), effects.end());
  return std::any_of(causes.begin(), causes.end(), [&](const Explanation& e) {
    std::set<int> named;
    for (const NamedEffect& n : e.effects) named.insert(n.effect);
    return named == wanted;
  });
}

}  // namespace drumsweep
