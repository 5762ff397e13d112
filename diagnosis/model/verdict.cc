#include "diagnosis/model/verdict.h"

namespace drumsweep {
namespace {

constexpr double established_rise = 16, established_nats = 3;

Verdict grade(const Misfit& misfit, const Naming& naming, const DiagnosisOptions& options) {
  if (misfit.p_value > options.alpha) return Verdict::nothing_wrong;
  if (naming.causes.empty()) return Verdict::none_of_these;
  if (naming.causes.size() > 1) return Verdict::ambiguous;
  const Explanation& e = naming.causes.front();
  const bool established = misfit.q0 - e.q >= established_rise && e.held_out_nats > established_nats &&
                           e.held_out_p > options.held_out_level;
  return established ? Verdict::established : Verdict::suspected;
}

/// Only in tests that must fail.
void relabel(std::vector<Explanation>& causes, const Mutation& mutation) {
  for (Explanation& e : causes)
    for (NamedEffect& named : e.effects) {
      if (mutation.swap_labels && named.effect < 2) named.effect = 1 - named.effect;
      if (mutation.flip_sign) {
        named.strength = -named.strength;
        std::swap(named.low, named.high);
        named.low = -named.low;
        named.high = -named.high;
      }
    }
}

/// Ends of a box round x, a few errors either way: the emulator may be off by more than its own.
LocalCentre box_round(const ModelFit& fit, const Problem& problem) {
  LocalCentre out{fit.effects, fit.x, Eigen::VectorXd(fit.x.size())};
  const auto num_parameters = static_cast<Eigen::Index>(problem.parameters.size());
  const auto rounded = [](double value) { return 1e-4 * std::round(1e4 * value); };
  for (Eigen::Index i = 0; i < fit.x.size(); ++i) {
    const double error = std::sqrt(fit.spread(i, i));
    double low = -design_reach, high = design_reach, reach = std::clamp(2 * error, 0.7, 1.6);
    if (i >= num_parameters) {
      const CandidateEffect& e =
          problem.effects[static_cast<std::size_t>(fit.effects[static_cast<std::size_t>(i - num_parameters)])];
      low = e.inner(e.low);
      high = e.inner(e.high);
      reach = std::clamp(3 * error, 0.15, 0.3);
    }
    const double from = std::clamp(fit.x[i] - reach, low, high - reach),
                 to = std::clamp(fit.x[i] + reach, low + reach, high);
    out.x[i] = rounded(0.5 * (from + to));
    out.half_width[i] = rounded(0.5 * (to - from));
  }
  return out;
}

}  // namespace

std::vector<LocalCentre> second_wave_of(const Diagnosis& first, const Problem& problem) {
  std::vector<LocalCentre> out;
  for (const ModelFit& fit : first.leading) out.push_back(box_round(fit, problem));
  return out;
}

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

Eigen::VectorXd scale_of(const Problem& problem) {
  Eigen::VectorXd scale(problem.num_data());
  for (Eigen::Index i = 0; i < problem.num_data(); ++i) scale[i] = problem.data[static_cast<std::size_t>(i)].sigma;
  return scale;
}

Diagnosis diagnose(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options,
                   const std::vector<LocalRuns>& second_wave) {
  const Inquiry inquiry(problem, emulator, options, second_wave);
  Diagnosis out;
  static_cast<Misfit&>(out) = test_misfit(inquiry);
  if (options.details) {
    static_cast<Whereabouts&>(out) = look_where(inquiry, out.plain);
    static_cast<Outlook&>(out) = look_at_candidates(inquiry, out);
  }
  if (out.p_value <= options.alpha) static_cast<Naming&>(out) = name_causes(inquiry, out);
  out.verdict = grade(out, out, options);
  if (!out.causes.empty()) out.gain = held_out_gain(inquiry, out.plain, out.causes.front().fit);
  if (options.details) {
    std::vector<const ModelFit*> members;
    for (const Explanation& e : out.causes) members.push_back(&e.fit);
    out.advice = advise(inquiry, members);
  }
  relabel(out.causes, options.mutation);
  return out;
}

}  // namespace drumsweep
