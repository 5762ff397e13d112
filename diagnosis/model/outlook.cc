#include "diagnosis/model/outlook.h"

#include <map>

#include "diagnosis/model/laws.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double unseen = 1.0;   // an effect below this d at the end of its range cannot matter here
constexpr double certain = 5.0;  // d at which isolation is looked at
constexpr double near_twins = 3.0;

/// The plain model's fit, with effects of any strength added one at a time.
struct Probe {
  const Inquiry& in;
  const ModelFit& plain;

  const SubModel& single(int k) const { return in.single_models[static_cast<std::size_t>(k)]; }
  /// What single effect k of strength p does to the fitted data (rotated).
  Eigen::VectorXd seen(int k, double p) const {
    Eigen::VectorXd x = Eigen::VectorXd::Constant(plain.x.size() + 1, p);
    x.head(plain.x.size()) = plain.x;
    return predict(single(k), x);
  }
  double detectability(int k, double p) const { return distance_to(in.plain_model, seen(k, p), plain.x); }
  /// Strength p on the side of `end` at which d has a value; NaN where it never has.
  double strength_at(int k, double end, double d) const {
    if (end == 0 || detectability(k, end) < d) return std::nan("");
    double low = 0, high = end;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = 0.5 * (low + high);
      (detectability(k, middle) < d ? low : high) = middle;
    }
    return high;
  }
};

/// Found in 9 of 10: the directed statistic passes its 97.5 % point with a margin of 1.28.
double found_at(std::vector<double> directed_draws) {
  if (directed_draws.empty()) return 3.0 + 1.28;
  std::sort(directed_draws.begin(), directed_draws.end());
  const double last = static_cast<double>(directed_draws.size() - 1);
  return std::sqrt(directed_draws[static_cast<std::size_t>(0.975 * last)]) + 1.28;
}

/// What is left after recalibration, against what each effect would leave.
std::vector<double> cosines(const Probe& probe, const std::vector<double>& at) {
  const Inquiry& in = probe.in;
  const Eigen::VectorXd variance = 1 + probe.plain.v * in.plain_model.space->lambda.array();
  const auto left = [&](const Eigen::VectorXd& z, const ModelFit& fit) {
    Eigen::VectorXd out = z - predict(in.plain_model, fit.x);
    for (Index i = 0; i < out.size(); ++i) out[i] /= std::sqrt(variance[i]);
    return out;
  };
  const Eigen::VectorXd residual = left(in.seen_by(in.plain_model), probe.plain);
  std::vector<double> out;
  for (int k = 0; k < in.num_effects; ++k) {
    const Eigen::VectorXd z = probe.seen(k, at[static_cast<std::size_t>(k)]);
    const Eigen::VectorXd signature = left(z, fit_model(in.plain_model, z, probe.plain.x));
    out.push_back(residual.dot(signature) / std::max(1e-12, residual.norm() * signature.norm()));
  }
  return out;
}

/// Least distance between two members of the set with these data.
double least_distance(const Inquiry& in, const std::vector<Index>& outputs, const Eigen::MatrixXd& covariance,
                      const std::vector<const ModelFit*>& members) {
  const std::shared_ptr<const FitSpace> space = in.space_of(outputs, covariance);
  double least = std::numeric_limits<double>::infinity();
  for (const ModelFit* a : members)
    for (const ModelFit* b : members) {
      if (a == b) continue;
      const SubModel truth = make_sub_model(in.emulator.of_model(a->effects), space, in.problem),
                     rival = make_sub_model(in.emulator.of_model(b->effects), space, in.problem);
      least = std::min(least, distance_to(rival, predict(truth, a->x), a->x.head(truth.num_parameters)));
    }
  return least;
}

}  // namespace

Outlook look_at_candidates(const Inquiry& in, const Misfit& misfit) {
  Outlook out;
  const Probe probe{in, misfit.plain};
  const double found = found_at(misfit.directed_draws);
  std::vector<double> at;
  for (int k = 0; k < in.num_effects; ++k) {
    const SubModel& m = probe.single(k);
    const double low = m.low[m.num_parameters], high = m.high[m.num_parameters];
    const CandidateEffect& e = in.problem.effects[static_cast<std::size_t>(k)];
    out.detection.push_back(
        {e.strength(probe.strength_at(k, low, found)), e.strength(probe.strength_at(k, high, found)),
         std::max(low == 0 ? 0 : probe.detectability(k, low), high == 0 ? 0 : probe.detectability(k, high))});
    const double end = high != 0 ? high : low, seen = probe.strength_at(k, end, certain);
    at.push_back(std::isnan(seen) ? end : seen);
  }
  out.isolation = Eigen::MatrixXd::Zero(in.num_effects, in.num_effects);
  for (int k = 0; k < in.num_effects; ++k) {
    const Eigen::VectorXd truth = probe.seen(k, at[static_cast<std::size_t>(k)]);
    for (int j = 0; j < in.num_effects; ++j)
      if (j != k) out.isolation(k, j) = distance_to(probe.single(j), truth, misfit.plain.x);
  }
  for (int a = 0; a < in.num_effects; ++a)
    for (int b = a + 1; b < in.num_effects; ++b) {
      const auto end_of = [&](int k) { return out.detection[static_cast<std::size_t>(k)].d_at_end; };
      if (std::min(end_of(a), end_of(b)) < unseen) continue;
      const double d = std::max(out.isolation(a, b), out.isolation(b, a));
      if (d < near_twins) out.twins.push_back({a, b, d, d < exact_twins});
    }
  out.pattern_cosine = cosines(probe, at);
  return out;
}

std::vector<Advice> advise(const Inquiry& in, const std::vector<const ModelFit*>& members) {
  std::vector<Advice> out;
  if (members.size() < 2 || members.size() > 12) return out;
  const double now = least_distance(in, in.fitted, in.covariance, members);
  const auto add = [&](const std::string& name, const std::vector<Index>& outputs, const Eigen::MatrixXd& covariance) {
    const double d = least_distance(in, outputs, covariance, members);
    out.push_back({name, d, d > 0 ? normal_cdf((d * d - rival_rise) / (2 * d)) : 0, std::max(0.0, d * d - now * now)});
  };
  add("repeat the campaign", in.fitted, 0.5 * in.covariance);
  std::map<std::string, std::vector<Index>> extra;
  for (const Index i : in.problem.with_use(Use::available))
    extra[in.problem.data[static_cast<std::size_t>(i)].condition].push_back(i);
  for (const auto& [condition, outputs] : extra) {
    std::vector<Index> all = in.fitted;
    all.insert(all.end(), outputs.begin(), outputs.end());
    add(condition, all, in.covariance);
  }
  std::stable_sort(out.begin(), out.end(), [](const Advice& a, const Advice& b) { return a.distance > b.distance; });
  return out;
}

}  // namespace drumsweep
