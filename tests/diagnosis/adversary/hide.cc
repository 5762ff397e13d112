#include "diagnosis/adversary/hide.h"

#include <fmt/format.h>

#include <atomic>
#include <sstream>
#include <thread>

#include "core/config/schema.h"
#include "diagnosis/model/draws.h"
#include "diagnosis/model/fit.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

void in_threads(int threads, std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t)
    pool.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    });
  for (std::thread& t : pool) t.join();
}

std::size_t index_of(const Campaign& campaign, const std::string& id) {
  for (std::size_t k = 0; k < campaign.candidates.size(); ++k)
    if (campaign.candidates[k].effect.id == id) return k;
  throw InputError(fmt::format("{}: candidate {} is not on the list", campaign.path, id));
}

Eigen::VectorXd drawn_parameters(const Campaign& campaign, std::int64_t seed) {
  return normal_draws(seed, Purpose::adversary, 1, static_cast<Index>(campaign.parameters.size()))
      .cwiseMax(-2)
      .cwiseMin(2);
}

/// Whether every condition can be simulated with this change.
bool is_possible(const Campaign& campaign, const Eigen::VectorXd& u, const KeyChange& change) {
  const Eigen::VectorXd off = Eigen::VectorXd::Zero(static_cast<Index>(campaign.candidates.size()));
  for (const Condition& c : campaign.conditions) try {
      std::vector<KeyChange> changes = campaign.changes(c, u, off);
      changes.push_back(change);
      c.check(changes);
    } catch (const InputError&) {
      return false;
    }
  return true;
}

}  // namespace

std::string HiddenTruth::key(const Campaign& campaign) const {
  std::string out = fmt::format("case {}\nseed {}\nrepeats {}\nsmooth {}\n", name, seed, repeats, smooth);
  for (Index j = 0; j < u.size(); ++j)
    out += fmt::format("parameter {} {}\n", campaign.parameters[static_cast<std::size_t>(j)].prior.id, u[j]);
  for (const auto& [id, phi] : effects) out += fmt::format("effect {} {}\n", id, phi);
  for (const KeyChange& c : outsider)
    out += fmt::format("outsider {} {} {}\n", static_cast<int>(c.how), c.key, c.value);
  return out;
}

HiddenTruth HiddenTruth::from_key(const std::string& key) {
  HiddenTruth out;
  std::istringstream lines(key);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string word, id;
    in >> word;
    if (word == "case") std::getline(in >> std::ws, out.name);
    double value = 0;
    if (word == "effect" && in >> id >> value) out.effects.emplace_back(id, value);
    int how = 0;
    if (word == "outsider" && in >> how >> id >> value)
      out.outsider.push_back({static_cast<KeyChange::How>(how), id, value});
  }
  return out;
}

MeasuredData measure_hidden(const Campaign& campaign, const MeasuredData& wanted, HiddenTruth& truth, int threads) {
  if (truth.u.size() == 0) truth.u = drawn_parameters(campaign, truth.seed);
  Campaign world = campaign;
  if (truth.smooth)
    for (Condition& c : world.conditions) {
      const std::string from = "method = \"nonsmooth\"";
      const std::size_t at = c.text.find(from);
      if (at != std::string::npos) c.text.replace(at, from.size(), "method = \"smooth\"");
    }
  Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Index>(campaign.candidates.size()));
  for (const auto& [id, phi] : truth.effects) {
    const std::size_t k = index_of(campaign, id);
    p[static_cast<Index>(k)] = campaign.candidates[k].effect.inner(phi);
  }
  // Every repeat and condition by itself.
  const std::size_t num_conditions = world.conditions.size(),
                    num = num_conditions * static_cast<std::size_t>(truth.repeats);
  std::vector<ConditionResult> results(num);
  in_threads(threads, num, [&](std::size_t i) {
    const Condition& c = world.conditions[i % num_conditions];
    std::vector<KeyChange> changes = world.changes(c, truth.u, p);
    changes.insert(changes.end(), truth.outsider.begin(), truth.outsider.end());
    results[i] = c.simulate(replicate_seed(truth.seed + 777'000'000'000, static_cast<double>(i + 1)), changes, {}, 1,
                            [] { return true; });
  });
  MeasuredData out = wanted;
  const Eigen::VectorXd error = normal_draws(truth.seed, Purpose::adversary, 2, static_cast<Index>(wanted.data.size()));
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    Datum& d = out.data[i];
    if (d.use == Use::available) continue;
    double sum = 0, count = 0;
    for (std::size_t r = campaign.index_of(d.condition); r < num; r += num_conditions) {
      const double value = read_off(results[r].observables, d.quantity, d.position);
      if (!std::isfinite(value)) continue;
      sum += value;
      ++count;
    }
    double value = sum / count;
    for (std::size_t k = 0; k < campaign.candidates.size(); ++k)
      value = campaign.candidates[k].observe(d.condition, d.quantity, value,
                                             campaign.candidates[k].effect.strength(p[static_cast<Index>(k)]));
    d.value = value + d.sigma * error[static_cast<Index>(i)];
  }
  return out;
}

std::string measured_csv(const MeasuredData& measured) {
  std::string out = "condition,quantity,position,value,sigma,unit,use\n";
  for (const Datum& d : measured.data)
    out += fmt::format("{},{},{},{},{},{},{}\n", d.condition, d.quantity,
                       std::isnan(d.position) ? "" : fmt::format("{}", d.position),
                       std::isnan(d.value) ? "" : fmt::format("{:.5g}", d.value), d.sigma, d.unit,
                       d.use == Use::fit       ? "fit"
                       : d.use == Use::holdout ? "holdout"
                                               : "available");
  return out;
}

HiddenTruth draw_truth(const Campaign& campaign, const std::string& kind, std::int64_t seed) {
  HiddenTruth truth;
  truth.seed = seed;
  truth.name = kind;
  const Eigen::VectorXd t = uniform_draws(seed, Purpose::adversary, 3, 8);
  const auto pick = [&](double r) {
    return static_cast<std::size_t>(r * static_cast<double>(campaign.candidates.size()));
  };
  const auto add = [&](std::size_t k, double r, double side) {
    const CandidateEffect& e = campaign.candidates[k].effect;
    const double size = 0.5 + 0.4 * r;
    truth.effects.emplace_back(e.id, e.low < 0 && side < 0.5 ? size * e.low : size * e.high);
  };
  if (kind == "single" || kind == "pair") {
    const std::size_t first = pick(t[0]);
    add(first, t[1], t[2]);
    const std::size_t second = pick(t[3]) == first ? (first + 1) % campaign.candidates.size() : pick(t[3]);
    if (kind == "pair") add(second, t[4], t[5]);
  } else if (kind == "outsider") {
    // Physics that is not on the list.
    const std::vector<KeyChange> all = {
        {KeyChange::How::below, "material.wall_friction", 0.5 + 0.4 * t[1], "material.friction"},
        {KeyChange::How::set, "effects.size_spread", 0.15 + 0.1 * t[1]},
        {KeyChange::How::set, "material.restitution", 0.5 + 0.4 * t[1]}};
    truth.u = drawn_parameters(campaign, seed);
    auto chosen = static_cast<std::size_t>(t[0] * static_cast<double>(all.size()));
    if (!is_possible(campaign, truth.u, all[chosen])) chosen = (chosen + 1) % all.size();
    truth.outsider.push_back(all[chosen]);
  } else if (kind != "none") {
    // A single one by name.
    add(index_of(campaign, kind), t[1], t[2]);
  }
  return truth;
}

std::vector<RunResult> simulate_campaign(const Campaign& campaign, int threads) {
  const auto num_design = static_cast<std::size_t>(campaign.num_runs());
  std::vector<RunResult> results(num_design + 2 * static_cast<std::size_t>(campaign.numerics_runs));
  in_threads(threads, results.size(), [&](std::size_t i) {
    results[i] = *simulate_run(campaign, design_point(campaign, i, num_design), 1, [] { return true; });
  });
  return results;
}

void simulate_second_wave(const Campaign& campaign, const std::vector<LocalCentre>& boxes, const MeasuredData& measured,
                          int threads, CampaignOutputs& outputs) {
  for (const LocalCentre& box : boxes) {
    std::vector<RunResult> results(num_local_runs(campaign, box));
    in_threads(threads, results.size(), [&](std::size_t i) {
      results[i] = *simulate_run(campaign, local_point(campaign, box, i), 1, [] { return true; });
    });
    read_off_local(campaign, box, results, measured, outputs);
  }
}

MeasuredData wanted_of(const Campaign& campaign) {
  MeasuredData wanted = read_measured(campaign);
  const auto one = simulate_run(campaign, design_point(campaign, 0, 1), 1, [] { return true; });
  match_measured(wanted, campaign.measured, campaign, one->observables);
  return wanted;
}

}  // namespace drumsweep
