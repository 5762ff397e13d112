#include "diagnosis/model/verdict.h"

#include <fmt/format.h>

#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "core/config/schema.h"
#include "diagnosis/model/draws.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double unseen = 1.0;       // an effect below this d at the end of its range cannot matter here
constexpr double certain = 5.0;      // d at which isolation is looked at
constexpr double exact_twins = 0.5;  // distance in sigma below which no such data tell two effects apart
constexpr double near_twins = 3.0;
constexpr double rival_rise = 3.84;  // in Q: rivals as near as this stay in the set
constexpr double twin_rise = 9;      // in Q: what the emulator's error may make between equal effects
constexpr double credible = 0.95;
constexpr double pairs_needed = 0.9;
constexpr double pairs_prior = 0.3;  // prior weight of all pairs together
constexpr double established_rise = 16, established_nats = 3, worse_nats = -3, clearly_worse = 3;

double square(double x) { return x * x; }

/// Part of the sorted numbers that is at least x, counted with x itself: never 0.
double tail(const std::vector<double>& draws, double x) {
  const auto above = std::count_if(draws.begin(), draws.end(), [x](double d) { return d >= x; });
  return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(draws.size()));
}

class Diagnoser {
 public:
  Diagnoser(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options)
      : problem_(problem), emulator_(emulator), options_(options) {
    num_effects_ = static_cast<int>(problem.effects.size());
    covariance_ = scaled_covariance();
    fit_ = problem.with_use(Use::fit);
    space_ = space_of(fit_, covariance_);
    measured_ = Eigen::VectorXd::Zero(problem.num_data());
    for (Index i = 0; i < problem.num_data(); ++i)
      measured_[i] = problem.data[static_cast<std::size_t>(i)].value / emulator.scale()[i];
    if (static_cast<Index>(fit_.size()) <= emulator.num_parameters())
      throw InputError(
          fmt::format("{} data with use = fit for {} free parameters: accepted is more data than free parameters",
                      fit_.size(), emulator.num_parameters()));
    z_ = space_.to_rotated * measured_(fit_);
    centre_ = Eigen::VectorXd::Zero(emulator.num_parameters());
    plain_model_ = model({});
    for (int k = 0; k < num_effects_; ++k) single_models_.push_back(model({k}));
  }

  Diagnosis run() {
    out_.num_fitted_data = static_cast<Index>(fit_.size());
    out_.plain = fit_plain(z_, centre_);
    out_.q0 = out_.plain.q;
    for (int k = 0; k < num_effects_; ++k)
      out_.singles.push_back(fit_model(single_models_[size(k)], space_, z_, centre_, true));
    test_misfit();
    if (options_.details) {
      look_where();
      look_at_candidates();
    }
    if (out_.p_value <= options_.alpha) name_causes();
    if (options_.details) advise();
    relabel();
    return std::move(out_);
  }

  /// The gain on held-out conditions of one fit over another.
  HeldOutGain gain_of(const ModelFit& plain, const ModelFit& best) const {
    const SubModel m = model(best.effects);
    HeldOutGain gain;
    const std::vector<Index> all = problem_.with_use(Use::holdout);
    if (all.empty()) return gain;
    for (const auto& [condition, outputs] : held_out_conditions()) {
      gain.conditions.push_back(condition);
      gain.nats.push_back(log_density(prediction(m, best, outputs), outputs).first -
                          log_density(prediction(plain_model_, plain, outputs), outputs).first);
    }
    const auto n = static_cast<double>(gain.nats.size());
    gain.mean = std::accumulate(gain.nats.begin(), gain.nats.end(), 0.0) / n;
    if (gain.nats.size() > 1) {
      // Few conditions, some of which see the effect and some not: a skewed sample, for which Student's interval covers too seldom.
      // Hall's transformation (J. R. Stat. Soc. B 54, 221, 1992) takes the skewness out.
      double squares = 0, cubes = 0;
      for (const double g : gain.nats) {
        squares += square(g - gain.mean);
        cubes += (g - gain.mean) * square(g - gain.mean);
      }
      const double s = std::sqrt(squares / (n - 1)), skewness = s > 0 ? cubes / n / (s * s * s) : 0;
      const auto bound = [&](double t) {
        const double x = t / std::sqrt(n);
        if (std::abs(skewness) < 1e-6) return gain.mean - s * x;
        return gain.mean - s * 3 / skewness * (std::cbrt(1 + skewness * (x - skewness / (6 * n))) - 1);
      };
      gain.low = bound(student_95(n - 1));
      gain.high = bound(-student_95(n - 1));
      gain.adopted = gain.low > 0;
    }
    // The same in errors and in units.
    const Prediction before = prediction(plain_model_, plain, all), after = prediction(m, best, all);
    struct Sum {
      double n = 0, before = 0, after = 0;
      std::string unit;
    };
    std::map<std::string, Sum> by_quantity;
    double z2_before = 0, z2_after = 0, in_before = 0, in_after = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto r = static_cast<Index>(i);
      const Datum& datum = problem_.data[size(all[i])];
      const double off0 = measured_[all[i]] - before.mean[r], off1 = measured_[all[i]] - after.mean[r];
      const double z0 = off0 / std::sqrt(before.covariance(r, r)), z1 = off1 / std::sqrt(after.covariance(r, r));
      z2_before += z0 * z0;
      z2_after += z1 * z1;
      in_before += std::abs(z0) < 1.645 ? 1 : 0;
      in_after += std::abs(z1) < 1.645 ? 1 : 0;
      Sum& sum = by_quantity[datum.quantity];
      sum.n += 1;
      sum.before += square(off0 * emulator_.scale()[all[i]]);
      sum.after += square(off1 * emulator_.scale()[all[i]]);
      sum.unit = datum.unit;
    }
    const auto num = static_cast<double>(all.size());
    gain.rms_z_before = std::sqrt(z2_before / num);
    gain.rms_z_after = std::sqrt(z2_after / num);
    gain.coverage_before = in_before / num;
    gain.coverage_after = in_after / num;
    for (const auto& [quantity, sum] : by_quantity)
      gain.quantities.push_back({quantity, sum.unit, std::sqrt(sum.before / sum.n), std::sqrt(sum.after / sum.n)});
    return gain;
  }

 private:
  bool listed(int k) const { return problem_.effects[size(k)].listed; }
  static std::size_t size(Index i) { return static_cast<std::size_t>(i); }

  Eigen::MatrixXd scaled_covariance() const {
    const auto scale = emulator_.scale().cwiseInverse().asDiagonal();
    Eigen::MatrixXd covariance = scale * problem_.measurement_covariance() * scale;
    if (options_.mutation.halve_covariance) covariance *= 0.5;
    return covariance;
  }
  FitSpace space_of(const std::vector<Index>& outputs, const Eigen::MatrixXd& covariance) const {
    return make_fit_space(emulator_, outputs, covariance(outputs, outputs),
                          {.with_simulation_noise = !options_.mutation.drop_simulation_noise});
  }
  SubModel model(const std::vector<int>& effects) const { return make_sub_model(emulator_, space_, problem_, effects); }

  ModelFit fit_plain(const Eigen::VectorXd& z, const Eigen::VectorXd& centre) const {
    if (!options_.mutation.skip_refit) return fit_model(plain_model_, space_, z, centre);
    SubModel fixed = plain_model_;
    fixed.low.setConstant(-1e-9);
    fixed.high.setConstant(1e-9);
    return fit_model(fixed, space_, z, Eigen::VectorXd::Zero(centre.size()));
  }

  /// Data and bench measurements as they could have been if `fit` were the truth.
  struct Drawn {
    Eigen::VectorXd z, centre;
  };
  Drawn draw(const SubModel& m, const ModelFit& fit, std::uint64_t index) const {
    const Index num = space_.lambda.size();
    const Eigen::VectorXd normal = normal_draws(options_.seed, Purpose::bootstrap, index, num + m.num_parameters);
    Drawn out;
    out.z = predict(m, fit.x) + ((1 + fit.v * space_.lambda.array()).sqrt() * normal.head(num).array()).matrix();
    out.centre = fit.x.head(m.num_parameters) + normal.tail(m.num_parameters);
    return out;
  }

  // --- 1. is anything wrong?

  /// Sums of squares of each group, of the residuals in the plain units.
  std::map<std::string, double> group_sums(const Eigen::VectorXd& z, const ModelFit& plain) const {
    const Eigen::VectorXd residual = space_.to_plain * (z - predict(plain_model_, plain.x));
    std::map<std::string, double> sums;
    for (std::size_t i = 0; i < fit_.size(); ++i) {
      const Index k = fit_[i];
      const double variance = covariance_(k, k) + plain.v * emulator_.noise()(k, k);
      sums[problem_.data[size(k)].group] += square(residual[static_cast<Index>(i)]) / variance;
    }
    return sums;
  }

  void test_misfit() {
    double directed = 0;
    for (int k = 0; k < num_effects_; ++k)
      if (listed(k)) directed = std::max(directed, out_.q0 - out_.singles[size(k)].q);
    const std::map<std::string, double> observed = group_sums(z_, out_.plain);
    std::map<std::string, std::vector<double>> group_draws;
    std::vector<double> omnibus_draws;
    for (int b = 0; b < options_.num_bootstraps; ++b) {
      const Drawn drawn = draw(plain_model_, out_.plain, static_cast<std::uint64_t>(b));
      const ModelFit plain = fit_plain(drawn.z, drawn.centre);
      omnibus_draws.push_back(plain.q);
      double best = 0;
      for (int k = 0; k < num_effects_; ++k) {
        if (!listed(k)) continue;
        const SubModel& single = single_models_[size(k)];
        Eigen::VectorXd start(single.dimensions());
        start << plain.x, 0.0;
        best = std::max(best, plain.q - fit_from(single, space_, drawn.z, drawn.centre, start).q);
      }
      directed_draws_.push_back(best);
      for (const auto& [group, sum] : group_sums(drawn.z, plain)) group_draws[group].push_back(sum);
    }
    out_.p_omnibus = tail(omnibus_draws, out_.q0);
    out_.p_directed = num_effects_ > 0 ? tail(directed_draws_, directed) : 1;
    out_.p_value = std::min(1.0, (num_effects_ > 0 ? 2 : 1) * std::min(out_.p_omnibus, out_.p_directed));
    out_.birge = std::sqrt(out_.plain.chi2 / static_cast<double>(fit_.size()));
    for (const auto& [group, sum] : observed) {
      std::size_t num = 0;
      for (const Index k : fit_) num += problem_.data[size(k)].group == group ? 1 : 0;
      out_.groups.push_back({group, num, sum, tail(group_draws[group], sum)});
    }
  }

  // --- 2. where?

  void look_where() {
    const Eigen::VectorXd full0 = Eigen::VectorXd::Zero(emulator_.num_parameters() + emulator_.num_effects());
    const Eigen::VectorXd full1 = full_point(emulator_, plain_model_, out_.plain.x);
    const Eigen::VectorXd before = emulator_.predict(full0), after = emulator_.predict(full1);
    const double v0 = emulator_.variance_factor(full0), v1 = emulator_.variance_factor(full1);
    const Index num_parameters = emulator_.num_parameters();
    const auto slopes = [&](const Eigen::VectorXd& x) {
      return Eigen::MatrixXd(emulator_.coefficients().transpose() * feature_slopes(x).leftCols(num_parameters));
    };
    const Eigen::MatrixXd j0 = slopes(full0), j1 = slopes(full1);
    for (Index i = 0; i < problem_.num_data(); ++i) {
      const double unit = emulator_.scale()[i], noise = emulator_.noise()(i, i), measured = covariance_(i, i);
      const double prior = j0.row(i).squaredNorm(), posterior = j1.row(i) * out_.plain.spread * j1.row(i).transpose();
      // Fitted data have pulled the fit towards them: the residual is smaller by its leverage.
      const bool fitted = problem_.data[size(i)].use == Use::fit;
      const double var0 = measured + v0 * noise + prior,
                   var1 = std::max(0.02 * measured, measured + v1 * noise + (fitted ? -posterior : posterior));
      DatumMisfit m{};
      m.simulated_before = before[i] * unit;
      m.simulated_after = after[i] * unit;
      m.sigma_before = unit * std::sqrt(v0 * noise + prior);
      m.sigma_after = unit * std::sqrt(v1 * noise + posterior);
      m.z_before = (measured_[i] - before[i]) / std::sqrt(var0);
      m.z_after = (measured_[i] - after[i]) / std::sqrt(var1);
      m.off_before = (measured_[i] - before[i]) / std::sqrt(measured + v0 * noise);
      out_.misfits.push_back(m);
    }
    for (Index j = 0; j < num_parameters; ++j) {
      // Prior and data disagree by (shift) / sqrt(prior variance - posterior variance).
      const double freed = std::max(1e-6, 1 - out_.plain.spread(j, j));
      out_.theta_z.push_back(out_.plain.x[j] / std::sqrt(freed));
      out_.at_edge = out_.at_edge || std::abs(out_.plain.x[j]) > fit_reach - 1e-6;
    }
  }

  // --- 3. candidates

  /// Distance in sigma of `truth` (noise-free, in the rotated coordinates of `space`) to the nearest point of a model.
  double distance(const SubModel& rival, const FitSpace& space, const Eigen::VectorXd& truth,
                  const Eigen::VectorXd& centre) const {
    // Two fits with the logarithms left out: their sum at the minimum is not part of a distance.
    const ModelFit fit = fit_model(rival, space, truth, centre, true);
    return std::sqrt(std::max(0.0, fit.chi2));
  }
  Eigen::VectorXd with_effect(double p) const {
    Eigen::VectorXd x(plain_model_.dimensions() + 1);
    x << out_.plain.x, p;
    return x;
  }
  double detectability(int k, double p) const {
    return distance(plain_model_, space_, predict(single_models_[size(k)], with_effect(p)), out_.plain.x);
  }
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

  void look_at_candidates() {
    // Found in 9 of 10: the directed statistic passes its 97.5 % point with a margin of 1.28.
    std::vector<double> sorted = directed_draws_;
    std::sort(sorted.begin(), sorted.end());
    const double threshold =
        sorted.empty() ? 3.0
                       : std::sqrt(sorted[static_cast<std::size_t>(0.975 * static_cast<double>(sorted.size() - 1))]);
    const double found = threshold + 1.28;
    out_.isolation = Eigen::MatrixXd::Zero(num_effects_, num_effects_);
    std::vector<double> at;
    for (int k = 0; k < num_effects_; ++k) {
      const SubModel& m = single_models_[size(k)];
      const double low = m.low[m.num_parameters], high = m.high[m.num_parameters];
      const CandidateEffect& e = problem_.effects[size(k)];
      Detection d{e.strength(strength_at(k, low, found)), e.strength(strength_at(k, high, found)),
                  std::max(low == 0 ? 0 : detectability(k, low), high == 0 ? 0 : detectability(k, high))};
      out_.detection.push_back(d);
      const double end = high != 0 ? high : low, seen = strength_at(k, end, certain);
      at.push_back(std::isnan(seen) ? end : seen);
    }
    for (int k = 0; k < num_effects_; ++k) {
      const Eigen::VectorXd truth = predict(single_models_[size(k)], with_effect(at[size(k)]));
      for (int j = 0; j < num_effects_; ++j)
        if (j != k) out_.isolation(k, j) = distance(single_models_[size(j)], space_, truth, out_.plain.x);
    }
    for (int a = 0; a < num_effects_; ++a)
      for (int b = a + 1; b < num_effects_; ++b) {
        if (std::min(out_.detection[size(a)].d_at_end, out_.detection[size(b)].d_at_end) < unseen) continue;
        const double d = std::max(out_.isolation(a, b), out_.isolation(b, a));
        if (d < near_twins) out_.twins.push_back({a, b, d, d < exact_twins});
      }
    // What is left after recalibration, against what each effect would leave.
    const Eigen::ArrayXd weight = (1 + out_.plain.v * space_.lambda.array()).sqrt().inverse();
    const auto left = [&](const Eigen::VectorXd& z, const ModelFit& fit) {
      return Eigen::VectorXd((weight * (z - predict(plain_model_, fit.x)).array()).matrix());
    };
    const Eigen::VectorXd residual = left(z_, out_.plain);
    for (int k = 0; k < num_effects_; ++k) {
      const Eigen::VectorXd z = predict(single_models_[size(k)], with_effect(at[size(k)]));
      const Eigen::VectorXd signature = left(z, fit_model(plain_model_, space_, z, out_.plain.x));
      out_.pattern_cosine.push_back(residual.dot(signature) / std::max(1e-12, residual.norm() * signature.norm()));
    }
  }

  // --- 4. causes

  bool adequate(const SubModel& m, const ModelFit& fit) const {
    // Far outside of any bootstrapped point there is no need to draw.
    const auto num = static_cast<double>(fit_.size());
    if (chi2_tail(fit.q / 1.5, num) < 1 - options_.adequate_level) return false;
    std::vector<double> draws;
    for (int b = 0; b < options_.adequate_bootstraps; ++b) {
      const Drawn drawn = draw(m, fit, 1'000'000 + static_cast<std::uint64_t>(b));
      Eigen::VectorXd start = fit.x;
      draws.push_back(fit_from(m, space_, drawn.z, drawn.centre, start).q);
    }
    std::sort(draws.begin(), draws.end());
    return fit.q <= draws[static_cast<std::size_t>(options_.adequate_level * static_cast<double>(draws.size() - 1))];
  }

  struct Candidate {
    SubModel model;
    ModelFit fit;
    double log_weight;
    bool adequate = false;
  };

  /// Of one model with so many effects.
  double log_prior(std::size_t num) const {
    const double n = num_effects_;
    return num == 1 ? std::log((1 - pairs_prior) / n) : std::log(pairs_prior / (0.5 * n * (n - 1)));
  }
  Candidate candidate(const std::vector<int>& effects, double log_prior_of_model) const {
    Candidate c{model(effects), {}, 0};
    c.fit = effects.size() == 1 ? out_.singles[size(effects[0])] : fit_model(c.model, space_, z_, centre_, true);
    c.log_weight = log_evidence(c.fit, c.model, problem_) + log_prior_of_model;
    return c;
  }

  void name_causes() {
    std::vector<Candidate> singles, pairs;
    for (int k = 0; k < num_effects_; ++k)
      if (listed(k)) singles.push_back(candidate({k}, log_prior(1)));
    for (int a = 0; a < num_effects_; ++a)
      for (int b = a + 1; b < num_effects_; ++b) {
        if (!listed(a) || !listed(b)) continue;
        Candidate pair = candidate({a, b}, log_prior(2));
        // A pair with one of its strengths at nothing is the single again.
        const Eigen::VectorXd p = pair.fit.x.tail(2);
        if (std::abs(p[0]) < 1e-3 || std::abs(p[1]) < 1e-3) continue;
        pairs.push_back(std::move(pair));
      }
    const auto judge = [&](std::vector<Candidate>& list) {
      bool any = false;
      // The evidence decides who is worth a bootstrap.
      double best = -std::numeric_limits<double>::infinity(), least_q = std::numeric_limits<double>::infinity();
      for (const Candidate& c : list) {
        best = std::max(best, c.log_weight);
        least_q = std::min(least_q, c.fit.q);
      }
      for (Candidate& c : list) {
        const bool in_reach = c.log_weight > best - 8 || c.fit.q < least_q + rival_rise;
        c.adequate = in_reach && adequate(c.model, c.fit);
        any = any || c.adequate;
      }
      return any;
    };
    const bool singles_do = judge(singles);
    double single_mass = 0, pair_mass = 0, most = -std::numeric_limits<double>::infinity();
    for (const auto* list : {&singles, &pairs})
      for (const Candidate& c : *list) most = std::max(most, c.log_weight);
    for (const Candidate& c : singles) single_mass += c.adequate ? std::exp(c.log_weight - most) : 0;
    for (const Candidate& c : pairs) pair_mass += std::exp(c.log_weight - most);
    const bool pairs_hold = !singles_do || pair_mass > pairs_needed * (pair_mass + single_mass);
    if (pairs_hold && judge(pairs))
      choose(pairs);
    else if (singles_do)
      choose(singles);
    grade();
  }

  /// The set among the adequate ones, and what the held-out conditions say to it.
  void choose(std::vector<Candidate>& list) {
    // As near to the data as an adequate one is adequate, on whichever side of its own 99 % point it lies.
    double adequate_q = std::numeric_limits<double>::infinity();
    for (const Candidate& c : list)
      if (c.adequate) adequate_q = std::min(adequate_q, c.fit.q);
    std::erase_if(list, [&](const Candidate& c) { return !c.adequate && c.fit.q > adequate_q + rival_rise; });
    std::sort(list.begin(), list.end(),
              [](const Candidate& a, const Candidate& b) { return a.log_weight > b.log_weight; });
    double total = 0, least_q = std::numeric_limits<double>::infinity(), reached = 0;
    for (const Candidate& c : list) {
      total += std::exp(c.log_weight - list.front().log_weight);
      least_q = std::min(least_q, c.fit.q);
    }
    std::vector<Explanation> members;
    for (const Candidate& c : list) {
      const double weight = std::exp(c.log_weight - list.front().log_weight) / total;
      const bool in_set = reached < credible || c.fit.q < least_q + rival_rise;
      reached += weight;
      if (in_set) members.push_back(explanation(c, weight));
    }
    // Who is refused must also do clearly worse than somebody who is not: near twins fall together or not at all.
    const auto fails = [&](const Explanation& e) {
      return !options_.mutation.skip_held_out && !std::isnan(e.held_out_p) &&
             (e.held_out_p < options_.held_out_level || e.held_out_nats < worse_nats);
    };
    double kept = -std::numeric_limits<double>::infinity();
    for (const Explanation& e : members)
      if (!fails(e)) kept = std::max(kept, e.held_out_nats);
    for (Explanation& e : members) {
      const bool refused = fails(e) && e.held_out_nats < kept - clearly_worse;
      const bool alone = std::isinf(kept) && fails(e);
      (refused || alone ? out_.refused : out_.causes).push_back(std::move(e));
    }
    add_twins(total, list.empty() ? 0 : list.front().log_weight);
    // Where every member would have to be stronger than it can be, none is the cause.
    if (std::all_of(out_.causes.begin(), out_.causes.end(),
                    [&](const Explanation& e) { return at_range_end(e.fit); })) {
      out_.refused.insert(out_.refused.end(), out_.causes.begin(), out_.causes.end());
      out_.causes.clear();
    }
    if (!out_.causes.empty()) out_.gain = gain_of(out_.plain, out_.causes.front().fit);
  }

  bool at_range_end(const ModelFit& fit) const {
    const SubModel m = model(fit.effects);
    for (Index i = m.num_parameters; i < fit.x.size(); ++i)
      for (const double end : {m.low[i], m.high[i]})
        if (end != 0 && std::abs(fit.x[i] - end) < 1e-3) return true;
    return false;
  }

  Explanation explanation(const Candidate& c, double weight) const {
    Explanation e;
    e.fit = c.fit;
    e.q = c.fit.q;
    e.weight = weight;
    for (std::size_t k = 0; k < c.fit.effects.size(); ++k) {
      const CandidateEffect& effect = problem_.effects[size(c.fit.effects[k])];
      const Interval interval = profile_interval(c.model, space_, z_, centre_, c.fit, k);
      e.effects.push_back({c.fit.effects[k], effect.strength(c.fit.x[c.model.num_parameters + static_cast<Index>(k)]),
                           effect.strength(interval.low), effect.strength(interval.high)});
    }
    judge_held_out(c, e);
    return e;
  }

  /// Distance in sigma below which these data, and an emulator of this accuracy, do not tell two models apart.
  double twin_distance(double v) const {
    const Eigen::ArrayXd part = v * space_.lambda.array();
    return std::max(exact_twins, 1.3 * std::sqrt(2 * (part / (1 + part)).sum()));
  }

  /// Confounding is declared, not fitted away: whoever cannot be told from a member is a member.
  void add_twins(double total, double log_most) {
    for (std::size_t i = 0; i < out_.causes.size(); ++i)
      for (std::size_t k = 0; k < out_.causes[i].fit.effects.size(); ++k)
        for (int j = 0; j < num_effects_; ++j) {
          const ModelFit fit = out_.causes[i].fit;
          std::vector<int> effects = fit.effects;
          if (!listed(j) || std::find(effects.begin(), effects.end(), j) != effects.end()) continue;
          effects[k] = j;
          std::sort(effects.begin(), effects.end());
          if (out_.names(effects)) continue;
          const SubModel truth = model(fit.effects), rival = model(effects);
          if (distance(rival, space_, predict(truth, fit.x), fit.x.head(truth.num_parameters)) > twin_distance(fit.v))
            continue;
          const Candidate twin = candidate(effects, log_prior(effects.size()));
          // Not a twin that has vanished in the fit, nor one that the data hold against all the same.
          const Eigen::VectorXd p = twin.fit.x.tail(static_cast<Index>(effects.size()));
          if (p.cwiseAbs().minCoeff() < 1e-3 || twin.fit.q > out_.causes[i].fit.q + twin_rise) continue;
          std::erase_if(out_.refused, [&](const Explanation& e) { return e.fit.effects == effects; });
          out_.causes.push_back(explanation(twin, total > 0 ? std::exp(twin.log_weight - log_most) / total : 0));
        }
  }

  void grade() {
    if (out_.causes.empty()) {
      out_.verdict = Verdict::none_of_these;
      return;
    }
    if (out_.causes.size() > 1) {
      out_.verdict = Verdict::ambiguous;
      return;
    }
    const Explanation& e = out_.causes.front();
    const bool established = out_.q0 - e.q >= established_rise && e.held_out_nats > established_nats &&
                             e.held_out_p > options_.held_out_level;
    out_.verdict = established ? Verdict::established : Verdict::suspected;
  }

  // --- 5. held-out conditions

  struct Prediction {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
  };
  Prediction prediction(const SubModel& m, const ModelFit& fit, const std::vector<Index>& outputs) const {
    const std::vector<Index> features = emulator_.features_of_model(m.effects);
    const Eigen::MatrixXd c = emulator_.coefficients()(features, outputs);
    const Eigen::MatrixXd slope = c.transpose() * feature_slopes(fit.x);
    return {c.transpose() * features_of(fit.x), covariance_(outputs, outputs) +
                                                    fit.v * emulator_.noise()(outputs, outputs) +
                                                    slope * fit.spread * slope.transpose()};
  }
  /// Of the measured values; and their chi^2.
  std::pair<double, double> log_density(const Prediction& p, const std::vector<Index>& outputs) const {
    const Eigen::VectorXd off = measured_(outputs) - p.mean;
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(p.covariance);
    const double chi2 = off.dot(ldlt.solve(off)), log_det = ldlt.vectorD().array().log().sum();
    const auto n = static_cast<double>(outputs.size());
    return {-0.5 * (chi2 + log_det + n * std::log(2 * std::numbers::pi)), chi2};
  }
  std::map<std::string, std::vector<Index>> held_out_conditions() const {
    std::map<std::string, std::vector<Index>> out;
    for (const Index i : problem_.with_use(Use::holdout)) out[problem_.data[size(i)].condition].push_back(i);
    return out;
  }

  void judge_held_out(const Candidate& c, Explanation& e) const {
    const std::vector<Index> outputs = problem_.with_use(Use::holdout);
    if (outputs.empty()) return;
    const auto [log_after, chi2] = log_density(prediction(c.model, c.fit, outputs), outputs);
    const double log_before = log_density(prediction(plain_model_, out_.plain, outputs), outputs).first;
    e.held_out_p = chi2_tail(chi2, static_cast<double>(outputs.size()));
    e.held_out_nats = log_after - log_before;
  }

  // --- 6. what to measure next

  /// Least distance between two members of the set with these data.
  double least_distance(const std::vector<Index>& outputs, const Eigen::MatrixXd& covariance,
                        const std::vector<const ModelFit*>& members) const {
    const FitSpace space = space_of(outputs, covariance);
    double least = std::numeric_limits<double>::infinity();
    for (const ModelFit* a : members)
      for (const ModelFit* b : members) {
        if (a == b) continue;
        const SubModel truth = make_sub_model(emulator_, space, problem_, a->effects),
                       rival = make_sub_model(emulator_, space, problem_, b->effects);
        least = std::min(least, distance(rival, space, predict(truth, a->x), a->x.head(truth.num_parameters)));
      }
    return least;
  }

  void advise() {
    std::vector<const ModelFit*> members;
    for (const Explanation& e : out_.causes) members.push_back(&e.fit);
    if (members.size() < 2 || members.size() > 12) return;
    const double now = least_distance(fit_, covariance_, members);
    const auto add = [&](const std::string& name, const std::vector<Index>& outputs,
                         const Eigen::MatrixXd& covariance) {
      const double d = least_distance(outputs, covariance, members);
      out_.advice.push_back(
          {name, d, d > 0 ? normal_cdf((d * d - rival_rise) / (2 * d)) : 0, std::max(0.0, d * d - now * now)});
    };
    add("repeat the campaign", fit_, 0.5 * covariance_);
    std::map<std::string, std::vector<Index>> extra;
    for (const Index i : problem_.with_use(Use::available)) extra[problem_.data[size(i)].condition].push_back(i);
    for (const auto& [condition, outputs] : extra) {
      std::vector<Index> all = fit_;
      all.insert(all.end(), outputs.begin(), outputs.end());
      add(condition, all, covariance_);
    }
    std::stable_sort(out_.advice.begin(), out_.advice.end(),
                     [](const Advice& a, const Advice& b) { return a.distance > b.distance; });
  }

  /// Only in tests that must fail.
  void relabel() {
    const auto change = [&](Explanation& e) {
      for (NamedEffect& named : e.effects) {
        if (options_.mutation.swap_labels && named.effect < 2) named.effect = 1 - named.effect;
        if (options_.mutation.flip_sign) {
          named.strength = -named.strength;
          std::swap(named.low, named.high);
          named.low = -named.low;
          named.high = -named.high;
        }
      }
    };
    for (Explanation& e : out_.causes) change(e);
  }

  const Problem& problem_;
  const Emulator& emulator_;
  const DiagnosisOptions options_;
  int num_effects_ = 0;
  Eigen::MatrixXd covariance_;  ///< of the measurements, in units of the scale
  std::vector<Index> fit_;      ///< data that are fitted
  FitSpace space_;
  Eigen::VectorXd measured_, z_, centre_;
  SubModel plain_model_;
  std::vector<SubModel> single_models_;
  std::vector<double> directed_draws_;
  Diagnosis out_;
};

}  // namespace

const char* to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::nothing_wrong:
      return "nothing_wrong";
    case Verdict::established:
      return "established";
    case Verdict::suspected:
      return "suspected";
    case Verdict::ambiguous:
      return "ambiguous";
    case Verdict::none_of_these:
      break;
  }
  return "none_of_these";
}

bool Diagnosis::names(const std::vector<int>& effects) const {
  const std::set<int> wanted(effects.begin(), effects.end());
  return std::any_of(causes.begin(), causes.end(), [&](const Explanation& e) {
    std::set<int> named;
    for (const NamedEffect& n : e.effects) named.insert(n.effect);
    return named == wanted;
  });
}

Eigen::VectorXd scale_of(const Problem& problem) {
  Eigen::VectorXd scale(problem.num_data());
  for (Index i = 0; i < problem.num_data(); ++i) scale[i] = problem.data[static_cast<std::size_t>(i)].sigma;
  return scale;
}

HeldOutGain held_out_gain(const Problem& problem, const Emulator& emulator, const ModelFit& plain, const ModelFit& best,
                          const DiagnosisOptions& options) {
  return Diagnoser(problem, emulator, options).gain_of(plain, best);
}

Diagnosis diagnose(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options) {
  return Diagnoser(problem, emulator, options).run();
}

}  // namespace drumsweep
