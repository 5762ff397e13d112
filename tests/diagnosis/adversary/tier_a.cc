#include "diagnosis/adversary/tier_a.h"

#include <fmt/format.h>

#include <numeric>

#include "diagnosis/model/draws.h"
#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr int num_parameters = 4, num_effects = 8, num_outsiders = 4, num_fitted = 32, num_held_out = 64,
              held_out_size = 3, used_held_out = 8;
enum Stream : std::uint64_t {
  slopes = 1,
  curvatures = 2,
  design = 1000,
  noise = 100'000,
  cases = 10'000'000,
  local = 1'000'000'000
};

Eigen::VectorXd normals(std::int64_t seed, std::uint64_t index, Index count) {
  return normal_draws(seed, Purpose::adversary, index, count);
}

/// Student's t with 5 degrees of freedom, scaled to variance 1.
Eigen::VectorXd heavy_tails(std::int64_t seed, std::uint64_t index, Index count) {
  const Eigen::VectorXd n = normals(seed, index, 6 * count);
  Eigen::VectorXd out(count);
  for (Index i = 0; i < count; ++i)
    out[i] = n[6 * i] / std::sqrt(n.segment(6 * i + 1, 5).squaredNorm() / 5) * std::sqrt(3.0 / 5);
  return out;
}

}  // namespace

SyntheticMachine::SyntheticMachine(std::int64_t machine_seed, double kink) : seed(machine_seed) {
  const char* groups[] = {"bench", "drum", "outlet", "belt"};
  for (int i = 0; i < num_fitted; ++i)
    problem.data.push_back({fmt::format("fitted_{}", i / 4), fmt::format("q{}", i % 4), std::nan(""), "m", 0, 1, "1",
                            groups[i / 8], Use::fit});
  for (int c = 0; c < num_held_out; ++c)
    for (int i = 0; i < held_out_size; ++i)
      problem.data.push_back({fmt::format("held_out_{:02}", c), fmt::format("q{}", i), std::nan(""), "m", 0, 1, "1",
                              groups[c % 4], Use::ignored});
  problem.data.push_back({"separator", "q", std::nan(""), "m", std::nan(""), 1, "1", "bench", Use::available});
  for (int j = 0; j < num_parameters; ++j) problem.parameters.push_back({fmt::format("theta_{}", j), "1", 0, 1});
  // Half of the effects have a sign.
  for (int k = 0; k < num_effects; ++k)
    problem.effects.push_back({fmt::format("effect_{}", k), "1", k % 2 == 0 ? 0.0 : -1.0, 1, 0.5});

  // Slopes: parameters move every datum by a sigma or so; effects act on two of the four groups, five sigma each at their ends.
  const Index q = problem.num_data(), n = num_parameters + num_effects;
  truth = Eigen::MatrixXd::Zero(num_features(n), q);
  std::uint64_t stream = slopes * 1000;
  for (Index i = 0; i < num_parameters; ++i) truth.row(1 + i) = normals(seed, stream++, q).transpose();
  const auto signature = [&](int k) {
    Eigen::RowVectorXd row = 4.5 * normals(seed, stream++, q).transpose();
    for (Index i = 0; i < q; ++i) {
      const std::string& group = problem.data[static_cast<std::size_t>(i)].group;
      if (group != groups[k % 4] && group != groups[(k + 1 + k / 4) % 4]) row[i] *= 0.15;
    }
    return row;
  };
  for (int k = 0; k < num_effects; ++k) truth.row(1 + num_parameters + k) = signature(k);
  // Products are a sixth of the slopes.
  Index feature = 1 + n;
  std::uint64_t bend = curvatures * 1000;
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j < n; ++j)
      truth.row(feature++) = normals(seed, bend++, q).transpose() * (i < num_parameters ? 0.15 : 0.4);
  // Twins: near ones differ by a tenth of their slopes, exact ones not at all.
  const auto copy_effect = [&](int from, int to, double difference) {
    // Feature by feature: `to` takes the role of `from`; of both together only the sum counts.
    const Index f = 1 + n;
    std::vector<std::pair<Index, Index>> of;
    for (Index i = 0; i < n; ++i)
      for (Index j = i; j < n; ++j) of.emplace_back(i, j);
    const auto index_of = [&](Index i, Index j) {
      for (std::size_t k = 0; k < of.size(); ++k)
        if (of[k] == std::pair{std::min(i, j), std::max(i, j)}) return f + static_cast<Index>(k);
      return Index{0};
    };
    const Index a = num_parameters + from, b = num_parameters + to;
    for (Index i = 0; i < n; ++i)
      if (i != a && i != b) truth.row(index_of(i, b)) = truth.row(index_of(i, a));
    truth.row(index_of(b, b)) = truth.row(index_of(a, a));
    truth.row(index_of(a, b)) = 2 * truth.row(index_of(a, a));
    truth.row(1 + b) = truth.row(1 + a) + difference * signature(to);
    problem.effects[static_cast<std::size_t>(to)].low = problem.effects[static_cast<std::size_t>(from)].low;
  };
  copy_effect(4, 5, 0.1);
  copy_effect(6, 7, 0.0);
  truth(1 + num_parameters + 4, q - 1) = 40;
  truth(1 + num_parameters + 5, q - 1) = -40;
  outsider_slope.resize(num_outsiders, q);
  for (int o = 0; o < num_outsiders; ++o) outsider_slope.row(o) = signature(o + 1);
  // Twins stay twins: only the others are bent.
  kink_slope = Eigen::MatrixXd::Zero(num_effects, q);
  for (int k = 0; k < 4; ++k) kink_slope.row(k) = kink * signature(k);
}

Eigen::VectorXd SyntheticMachine::mean(const Eigen::VectorXd& u, const Eigen::VectorXd& p) const {
  Eigen::VectorXd x(u.size() + p.size());
  x << u, p;
  Eigen::VectorXd out = transposed_times(truth, features_of(x));
  for (Index k = 0; k < p.size(); ++k) out += std::max(0.0, std::abs(p[k]) - 0.5) * kink_slope.row(k).transpose();
  return out;
}

CampaignRuns SyntheticMachine::campaign(Index runs, bool share_seeds) const {
  CampaignRuns out;
  out.parameters.resize(runs, num_parameters);
  out.strengths = Eigen::MatrixXd::Zero(runs, num_effects);
  out.outputs.resize(runs, problem.num_data());
  for (Index i = 0; i < runs; ++i) {
    const auto run = static_cast<std::uint64_t>(i);
    const Eigen::VectorXd at = uniform_draws(seed, Purpose::campaign, Stream::design + run, num_parameters + 6);
    out.parameters.row(i) = design_reach * (2 * at.head(num_parameters).array() - 1).matrix().transpose();
    const double kind = at[num_parameters];
    const int number = kind < 0.15 ? 0 : kind < 0.6 ? 1 : 2;
    const int first = static_cast<int>(at[num_parameters + 1] * num_effects),
              second = (first + 1 + static_cast<int>(at[num_parameters + 2] * (num_effects - 1))) % num_effects;
    const auto strength = [&](int k, double t) {
      const double low = problem.effects[static_cast<std::size_t>(k)].low;
      return low + (1 - low) * t;
    };
    if (number > 0) out.strengths(i, first) = strength(first, at[num_parameters + 3]);
    if (number > 1) out.strengths(i, second) = strength(second, at[num_parameters + 4]);
    const Eigen::VectorXd error = heavy_tails(seed, Stream::noise + (share_seeds ? 0 : run), problem.num_data());
    out.outputs.row(i) =
        (mean(out.parameters.row(i).transpose(), out.strengths.row(i).transpose()) + error).transpose();
  }
  return out;
}

LocalRuns SyntheticMachine::local_runs(const LocalCentre& box, Index num_runs, std::uint64_t number) const {
  LocalRuns out{box, Eigen::MatrixXd(num_runs, box.x.size()), Eigen::MatrixXd(num_runs, problem.num_data())};
  for (Index i = 0; i < num_runs; ++i) {
    const std::uint64_t run = Stream::local + 10'000 * number + static_cast<std::uint64_t>(i);
    const Eigen::VectorXd at = uniform_draws(seed, Purpose::campaign, run, box.x.size());
    const Eigen::VectorXd x = box.x + box.half_width.cwiseProduct((2 * at.array() - 1).matrix());
    Eigen::VectorXd p = Eigen::VectorXd::Zero(num_effects);
    for (std::size_t k = 0; k < box.effects.size(); ++k) p[box.effects[k]] = x[num_parameters + static_cast<Index>(k)];
    out.x.row(i) = x.transpose();
    out.outputs.row(i) = (mean(x.head(num_parameters), p) + heavy_tails(seed, run, problem.num_data())).transpose();
  }
  return out;
}

namespace {

/// Inverse covariance of the fitted data with theta integrated over its prior, at u (linearised), and the fitted part of a change.
Eigen::MatrixXd information(const SyntheticMachine& m, const Eigen::VectorXd& u) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(num_parameters + num_effects);
  x.head(num_parameters) = u;
  const Eigen::MatrixXd j = (m.truth.transpose() * feature_slopes(x).leftCols(num_parameters)).topRows(num_fitted);
  // Measurement 1, simulation noise through the emulator about v = 0.1.
  const Eigen::MatrixXd s = 1.1 * Eigen::MatrixXd::Identity(num_fitted, num_fitted) + j * j.transpose();
  return inverse_symmetric(s);
}

}  // namespace

double SyntheticMachine::detectability(const Eigen::VectorXd& u, const Eigen::VectorXd& change) const {
  const Eigen::VectorXd c = change.head(num_fitted);
  return std::sqrt(c.dot(information(*this, u) * c));
}

double SyntheticMachine::distance_to(const Eigen::VectorXd& u, const Eigen::VectorXd& change, int rival) const {
  const Eigen::MatrixXd w = information(*this, u);
  const double low = problem.effects[static_cast<std::size_t>(rival)].low;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= 100; ++step) {
    Eigen::VectorXd p = Eigen::VectorXd::Zero(num_effects);
    p[rival] = low + (1 - low) * step / 100;
    const Eigen::VectorXd c = (change - (mean(u, p) - mean(u, 0 * p))).head(num_fitted);
    least = std::min(least, c.dot(w * c));
  }
  return std::sqrt(least);
}

SealedCase draw_case(const SyntheticMachine& machine, Hidden kind, std::uint64_t number, double d_low, double d_high,
                     const std::vector<int>& among) {
  SealedCase out;
  out.kind = kind;
  const std::uint64_t base = Stream::cases + 100 * number;
  for (std::uint64_t attempt = 0; attempt < 50; ++attempt) {
    const Eigen::VectorXd t = uniform_draws(machine.seed, Purpose::adversary, base + attempt, 8);
    out.u = normals(machine.seed, base + 50, num_parameters).cwiseMax(-2).cwiseMin(2);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(num_effects), change = Eigen::VectorXd::Zero(machine.problem.num_data());
    out.effects.clear();
    out.strengths.clear();
    const double wanted = d_low + (d_high - d_low) * t[0];
    if (kind == Hidden::single || kind == Hidden::pair || kind == Hidden::impostor) {
      const auto pick = [&](double r) {
        return among[static_cast<std::size_t>(r * static_cast<double>(among.size()))];
      };
      out.effects.push_back(pick(t[1]));
      if (kind == Hidden::pair) {
        const int other = pick(t[2]);
        if (other == out.effects[0]) continue;
        out.effects.push_back(other);
        std::sort(out.effects.begin(), out.effects.end());
      }
      std::vector<double> sign;
      for (std::size_t k = 0; k < out.effects.size(); ++k)
        sign.push_back(machine.problem.effects[static_cast<std::size_t>(out.effects[k])].low < 0 &&
                               t[3 + static_cast<Index>(k)] < 0.5
                           ? -1
                           : 1);
      // Scaled up together until d is as wanted; a pair also has to be that far from each of its members.
      const auto at = [&](double scale) {
        for (std::size_t k = 0; k < out.effects.size(); ++k)
          p[out.effects[k]] = sign[k] * scale * (k == 0 || out.effects.size() == 1 ? 1 : 0.7 + 0.3 * t[5]);
        change = machine.mean(out.u, p) - machine.mean(out.u, 0 * p);
        if (kind != Hidden::pair) return machine.detectability(out.u, change);
        double least = machine.detectability(out.u, change);
        for (int k = 0; k < num_effects; ++k) least = std::min(least, machine.distance_to(out.u, change, k));
        return least;
      };
      double scale = 0.95;
      if (at(scale) < wanted) continue;
      double below = 0;
      for (int halving = 0; halving < 12; ++halving) {
        const double middle = 0.5 * (below + scale);
        (at(middle) < wanted ? below : scale) = middle;
      }
      out.d = at(scale);
      for (const int k : out.effects) out.strengths.push_back(p[k]);
      if (kind == Hidden::impostor) {
        const auto o = static_cast<Index>(t[6] * num_outsiders);
        const Index held = change.size() - num_fitted;
        change.tail(held) = p.norm() * machine.outsider_slope.row(o).tail(held).transpose();
        out.effects.clear();
        out.strengths.clear();
      }
    } else if (kind == Hidden::outsider) {
      const auto o = static_cast<Index>(t[1] * num_outsiders);
      change = machine.outsider_slope.row(o).transpose();
      change *= wanted / machine.detectability(out.u, change);
      out.d = wanted;
    }
    out.nearest = std::numeric_limits<double>::infinity();
    if (kind != Hidden::nothing)
      for (int k = 0; k < num_effects; ++k) {
        if (kind == Hidden::single && k == out.effects[0]) continue;
        const double distance = machine.distance_to(out.u, change, k);
        if (distance >= out.nearest) continue;
        out.nearest = distance;
        out.nearest_rival = k;
      }

    // Measured: the truth and the measurement's error. Averaging is long: no simulation noise in it.
    out.problem = machine.problem;
    const Eigen::VectorXd clean = machine.mean(out.u, Eigen::VectorXd::Zero(num_effects)) + change;
    const Index q = out.problem.num_data();
    const Eigen::VectorXd error = normals(machine.seed, base + 51, q), other = normals(machine.seed, base + 52, q);
    out.population = out.problem;
    for (Index i = 0; i < q; ++i) {
      auto& datum = out.problem.data[static_cast<std::size_t>(i)];
      auto& of_all = out.population.data[static_cast<std::size_t>(i)];
      datum.value = clean[i] + error[i];
      of_all.value = clean[i] + (datum.use == Use::fit ? error[i] : other[i]);
      if (of_all.use == Use::ignored) of_all.use = Use::holdout;
    }
    // Eight of the held-out conditions.
    const Eigen::VectorXd order = uniform_draws(machine.seed, Purpose::adversary, base + 53, num_held_out);
    std::vector<int> conditions(num_held_out);
    std::iota(conditions.begin(), conditions.end(), 0);
    std::sort(conditions.begin(), conditions.end(), [&](int a, int b) { return order[a] < order[b]; });
    for (int c = 0; c < used_held_out; ++c)
      for (int i = 0; i < held_out_size; ++i)
        out.problem
            .data[static_cast<std::size_t>(num_fitted + conditions[static_cast<std::size_t>(c)] * held_out_size + i)]
            .use = Use::holdout;
    return out;
  }
  out.effects.clear();
  out.kind = Hidden::nothing;
  out.d = -1;  // no such case on this machine
  return out;
}

double binomial_at_most(int yes, int of, double rate) {
  double sum = 0;
  for (int k = 0; k <= yes; ++k)
    sum += std::exp(std::lgamma(of + 1.0) - std::lgamma(k + 1.0) - std::lgamma(of - k + 1.0) + k * std::log(rate) +
                    (of - k) * std::log1p(-rate));
  return std::min(1.0, sum);
}
double binomial_at_least(int yes, int of, double rate) {
  return yes == 0 ? 1.0 : 1 - binomial_at_most(yes - 1, of, rate);
}

TierAScore run_tier_a(const TierAOptions& options) {
  TierAScore score;
  score.confusion = Eigen::MatrixXi::Zero(num_effects + 2, 5);
  for (int machine_number = 0; machine_number < options.machines; ++machine_number) {
    const SyntheticMachine machine(options.first_seed + machine_number, options.kink);
    const Emulator emulator(machine.campaign(options.num_runs, options.mutation.share_seeds),
                            scale_of(machine.problem));
    DiagnosisOptions how;
    how.seed = machine.seed;
    how.num_bootstraps = options.num_bootstraps;
    how.adequate_bootstraps = 200;
    how.details = false;
    how.mutation = options.mutation;
    std::uint64_t number = 0;
    const auto each = [&](Hidden kind, double low, double high, const std::vector<int>& among, int num,
                          const auto& judge) {
      for (int i = 0; i < num; ++i) {
        const SealedCase hidden = draw_case(machine, kind, number++, low, high, among);
        if (hidden.d < 0) continue;
        Diagnosis found = diagnose(hidden.problem, emulator, how);
        std::vector<LocalRuns> wave;
        for (const LocalCentre& box : second_wave_of(found, hidden.problem))
          if (options.second_wave > 0)
            wave.push_back(machine.local_runs(box, options.second_wave, 10 * number + wave.size()));
        if (!wave.empty()) found = diagnose(hidden.problem, emulator, how, wave);
        const int row = kind == Hidden::nothing    ? num_effects
                        : kind == Hidden::outsider ? num_effects + 1
                        : kind == Hidden::single   ? hidden.effects[0]
                                                   : -1;
        if (row >= 0) {
          const bool in_set = kind == Hidden::single && found.names(hidden.effects);
          const int column = found.verdict == Verdict::nothing_wrong   ? 4
                             : found.verdict == Verdict::none_of_these ? 3
                             : !in_set                                 ? 2
                             : found.causes.size() > 1                 ? 1
                                                                       : 0;
          score.confusion(row, column) += 1;
        }
        judge(hidden, found);
        // Strengths and gain of what was named.
        for (const Explanation& e : found.causes) {
          if (kind != Hidden::single && kind != Hidden::pair) break;
          if (e.effects.size() != hidden.effects.size()) continue;
          bool same = true;
          for (std::size_t k = 0; k < e.effects.size(); ++k) same = same && e.effects[k].effect == hidden.effects[k];
          if (!same) continue;
          for (std::size_t k = 0; k < e.effects.size(); ++k) {
            score.strength_off.push_back((e.effects[k].strength - hidden.strengths[k]) / hidden.strengths[k]);
            score.strength_covers.add(hidden.strengths[k] >= e.effects[k].low - 1e-9 &&
                                      hidden.strengths[k] <= e.effects[k].high + 1e-9);
          }
        }
        if (!found.causes.empty() && kind == Hidden::single) {
          const HeldOutGain of_all =
              held_out_gain(Inquiry(hidden.population, emulator, how, wave), found.plain, found.causes.front().fit);
          score.gain_covers.add(of_all.mean >= found.gain.low && of_all.mean <= found.gain.high);
        }
      }
    };
    const int n = options.cases_per_class;
    const auto named = [](const Diagnosis& d) { return !d.causes.empty(); };
    each(Hidden::nothing, 0, 0, {}, 2 * n, [&](const SealedCase&, const Diagnosis& d) {
      score.false_alarm.add(d.verdict != Verdict::nothing_wrong);
      score.control_gain.add(d.gain.adopted);
    });
    if (options.only_null) continue;
    each(Hidden::single, 5, 9, {0, 1, 2, 3}, n, [&](const SealedCase& c, const Diagnosis& d) {
      if (c.nearest < 5) return;
      score.clear_right.add(d.causes.size() == 1 && d.names(c.effects));
      score.clear_misnamed.add(named(d) && !d.names(c.effects));
    });
    each(Hidden::single, 4, 5, {0, 1, 2, 3}, n,
         [&](const SealedCase& c, const Diagnosis& d) { score.weak_in_set.add(d.names(c.effects)); });
    each(Hidden::pair, 6, 9, {0, 1, 2, 3}, n,
         [&](const SealedCase& c, const Diagnosis& d) { score.pair_in_set.add(d.names(c.effects)); });
    each(Hidden::outsider, 6, 10, {}, n, [&](const SealedCase& c, const Diagnosis& d) {
      // What a listed effect imitates within the errors is that effect, as far as these data go.
      if (c.nearest < 5) return;
      (c.d >= 8 ? score.outsider_named_8 : score.outsider_named).add(named(d));
    });
    each(Hidden::impostor, 7, 9, {0, 1, 2, 3}, n,
         [&](const SealedCase&, const Diagnosis& d) { score.impostor_named.add(named(d)); });
    each(Hidden::single, 6, 9, {6, 7}, n / 2, [&](const SealedCase& c, const Diagnosis& d) {
      score.exact_both.add(d.names({6}) && d.names({7}));
      score.exact_apart.add(d.names(c.effects) != d.names({13 - c.effects[0]}));
    });
    how.details = true;
    each(Hidden::single, 6, 9, {4, 5}, n / 2, [&](const SealedCase& c, const Diagnosis& d) {
      score.near_misnamed.add(named(d) && !d.names(c.effects));
      if (d.verdict != Verdict::ambiguous || d.advice.empty()) return;
      // Make the advised measurement and look again.
      Problem more = c.problem;
      for (Datum& datum : more.data)
        if (datum.condition == d.advice.front().measurement) datum.use = Use::fit;
      const Diagnosis then = diagnose(more, emulator, how);
      score.near_resolved.add(then.causes.size() == 1 && then.names(c.effects));
    });
  }
  return score;
}

namespace {

/// What the method asks of a rate.
struct Gate {
  const char* what;
  Count TierAScore::*count;
  double least, most;
};
constexpr double all = 1 - 1e-9, none = 1e-9;
const Gate gates[] = {
    {"false alarms", &TierAScore::false_alarm, 0, 0.05},
    {"d >= 5, D >= 5: uniquely right", &TierAScore::clear_right, 0.95, 1},
    {"d >= 5, D >= 5: misnamed", &TierAScore::clear_misnamed, 0, 0.01},
    {"d in [4, 5): truth in the set", &TierAScore::weak_in_set, 0.85, 1},
    {"pairs, 6 sigma from any single: in the set", &TierAScore::pair_in_set, 0.95, 1},
    {"outsiders d in [6, 8): named", &TierAScore::outsider_named, 0, 0.05},
    {"outsiders d >= 8: named", &TierAScore::outsider_named_8, 0, 0.01},
    {"impostors (held-out data differ): named", &TierAScore::impostor_named, 0, 0.05},
    {"exact twins: both named", &TierAScore::exact_both, all, 1},
    {"exact twins: one without the other", &TierAScore::exact_apart, 0, none},
    {"near twins: misnamed", &TierAScore::near_misnamed, 0, 0.025},
    {"near twins: resolved by the advised measurement", &TierAScore::near_resolved, 0.95, 1},
    {"gain interval covers", &TierAScore::gain_covers, 0.90, 0.98},
    {"strength interval covers", &TierAScore::strength_covers, 0.92, 0.97},
    {"null data: a gain adopted", &TierAScore::control_gain, 0, 0.025},
};

std::string accepted(const Gate& gate) {
  if (gate.most == none) return "0";
  if (gate.least > 0 && gate.most < 1) return fmt::format("{:.3g}-{:.3g} %", 100 * gate.least, 100 * gate.most);
  return gate.least > 0 ? fmt::format(">= {:.3g} %", 100 * gate.least) : fmt::format("<= {:.3g} %", 100 * gate.most);
}

}  // namespace

std::vector<std::string> TierAScore::missed() const {
  std::vector<std::string> out;
  for (const Gate& gate : gates) {
    const Count& c = this->*gate.count;
    const bool too_few = gate.least > 0 && binomial_at_most(c.yes, c.of, gate.least) < 0.01,
               too_many = gate.most < 1 && binomial_at_least(c.yes, c.of, gate.most) < 0.01;
    if (c.of > 0 && (too_few || too_many))
      out.push_back(fmt::format("{}: {} of {}, accepted is {}", gate.what, c.yes, c.of, accepted(gate)));
  }
  return out;
}

std::string TierAScore::table() const {
  std::string out;
  for (const Gate& gate : gates) {
    const Count& c = this->*gate.count;
    out +=
        fmt::format("{:<52}{:>6} of {:<6} {:>6.1f} %   {}\n", gate.what, c.yes, c.of, 100 * c.rate(), accepted(gate));
  }
  double sum = 0, squares = 0;
  for (const double off : strength_off) {
    sum += off;
    squares += off * off;
  }
  const double num = std::max<double>(1, static_cast<double>(strength_off.size()));
  out += fmt::format("strengths are off by {:+.1f} % on average, {:.1f} % rms\n", 100 * sum / num,
                     100 * std::sqrt(squares / num));
  out += "\nhidden \\ verdict   unique right  set with it  set without  none of these  nothing wrong\n";
  for (Eigen::Index r = 0; r < confusion.rows(); ++r) {
    out += fmt::format("{:<19}", r < 8 ? fmt::format("effect_{}", r) : r == 8 ? "nothing" : "outsider");
    for (Eigen::Index c = 0; c < 5; ++c) out += fmt::format("{:>12}", confusion(r, c));
    out += '\n';
  }
  return out;
}

}  // namespace drumsweep
