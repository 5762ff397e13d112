#include "diagnosis/model/fit.h"

#include <numbers>

#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

constexpr int max_steps = 40;

/// What a step of the minimisation needs at a point.
struct Point {
  double s = 0, chi2 = 0, v = 0;
  Eigen::VectorXd gradient;   ///< of S / 2
  Eigen::MatrixXd curvature;  ///< Gauss-Newton, of S / 2
};

Point look(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre, const Eigen::VectorXd& x,
           bool slopes) {
  Point at;
  const Eigen::Index num_outputs = z.size(), num_parameters = model.num_parameters;
  const Eigen::VectorXd f = features_of(x), af = times(model.a, f);
  at.v = f.dot(af);
  const Eigen::VectorXd residual = z - transposed_times(model.coefficients, f), off = x.head(num_parameters) - centre;
  Eigen::VectorXd weight(num_outputs), pull(num_outputs);
  double ds_dv = 0;  // S also changes with v(x)
  for (Eigen::Index i = 0; i < num_outputs; ++i) {
    const double lambda = model.space->lambda[i], variance = 1 + at.v * lambda, square = residual[i] * residual[i];
    weight[i] = 1 / variance;
    pull[i] = weight[i] * residual[i];
    at.chi2 += square / variance;
    at.s += std::log(variance);
    ds_dv += lambda / variance - square * lambda / (variance * variance);
  }
  at.chi2 += off.squaredNorm();
  at.s += at.chi2 + model.space->log_scale;
  if (!slopes) return at;

  const Eigen::MatrixXd slope = feature_slopes(x);
  const Eigen::MatrixXd jacobian = transposed_product(model.coefficients, slope);  // (outputs x dimensions)
  at.gradient = ds_dv * transposed_times(slope, af) - transposed_times(jacobian, pull);
  at.curvature = weighted_gram(jacobian, weight);
  for (Eigen::Index j = 0; j < num_parameters; ++j) {
    at.gradient[j] += off[j];
    at.curvature(j, j) += 1;
  }
  return at;
}

/// Levenberg's method in a box; what lies on a side and wants out is held there. `held`: a coordinate that does not move.
Eigen::VectorXd minimise(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                         Eigen::VectorXd x, Eigen::Index held = -1) {
  const Eigen::Index n = x.size();
  Point at = look(model, z, centre, x, true);
  double damping = 1e-4;
  for (int step = 0; step < max_steps; ++step) {
    Eigen::MatrixXd h = at.curvature;
    Eigen::VectorXd g = at.gradient;
    for (Eigen::Index i = 0; i < n; ++i) h(i, i) = h(i, i) * (1 + damping) + 1e-9;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool stuck = i == held || (x[i] <= model.low[i] && g[i] > 0) || (x[i] >= model.high[i] && g[i] < 0);
      if (!stuck) continue;
      h.row(i).setZero();
      h.col(i).setZero();
      h(i, i) = 1;
      g[i] = 0;
    }
    const Eigen::VectorXd next = (x - solve_symmetric(h, g)).cwiseMax(model.low).cwiseMin(model.high);
    const double moved = (next - x).cwiseAbs().maxCoeff();
    if (moved < 1e-7) break;
    const Point then = look(model, z, centre, next, true);
    if (then.s < at.s) {
      const double gained = at.s - then.s;
      x = next;
      at = then;
      damping = std::max(1e-6, 0.2 * damping);
      if (gained < 1e-6) break;
    } else {
      damping *= 8;
      if (damping > 1e8) break;
    }
  }
  return x;
}

}  // namespace

std::shared_ptr<const FitSpace> make_fit_space(const Eigen::MatrixXd& noise, const std::vector<Eigen::Index>& outputs,
                                               const Eigen::MatrixXd& measured, const FitOptions& options,
                                               const Eigen::VectorXd& lack_of_fit) {
  FitSpace space;
  space.outputs = outputs;
  Eigen::MatrixXd covariance = measured;
  if (lack_of_fit.size() > 0) {
    covariance.diagonal() += lack_of_fit(outputs);
    space.log_scale = log_determinant_symmetric(covariance) - log_determinant_symmetric(measured);
  }
  // V^T covariance V = 1, V^T noise V = lambda.
  const auto [vectors, values] = diagonalise_together(noise(outputs, outputs), covariance);
  space.to_rotated = vectors.transpose();
  space.to_plain = product(covariance, vectors);
  space.lambda = values.cwiseMax(0);
  if (!options.with_simulation_noise) space.lambda.setZero();
  return std::make_shared<const FitSpace>(std::move(space));
}

SubModel make_sub_model(const ModelEmulator& emulator, const std::shared_ptr<const FitSpace>& space,
                        const Problem& problem) {
  SubModel model;
  model.effects = emulator.effects;
  model.num_parameters = emulator.num_parameters;
  model.space = space;
  model.coefficients = product_transposed(emulator.coefficients(Eigen::all, space->outputs), space->to_rotated);
  model.a = emulator.a;
  model.low = Eigen::VectorXd::Constant(model.dimensions(), -fit_reach);
  model.high = -model.low;
  for (std::size_t k = 0; k < model.effects.size(); ++k) {
    const CandidateEffect& e = problem.effects[static_cast<std::size_t>(model.effects[k])];
    const Eigen::Index i = model.num_parameters + static_cast<Eigen::Index>(k);
    model.low[i] = e.inner(e.low);
    model.high[i] = e.inner(e.high);
  }
  return model;
}

ModelFit fit_from(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                  const Eigen::VectorXd& start) {
  ModelFit fit;
  fit.effects = model.effects;
  fit.x = minimise(model, z, centre, start);
  const Point at = look(model, z, centre, fit.x, true);
  fit.q = at.s;
  fit.chi2 = at.chi2;
  fit.v = at.v;
  const Eigen::Index n = fit.x.size();
  Eigen::MatrixXd curvature = at.curvature;
  // A strength is known to lie in its range, whether or not the data see it.
  for (Eigen::Index i = model.num_parameters; i < n; ++i) curvature(i, i) += 1;
  fit.spread = inverse_symmetric(curvature);
  return fit;
}

ModelFit fit_model(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre, bool thorough) {
  Eigen::VectorXd start(model.dimensions());
  start.setZero();
  start.head(centre.size()) = centre.cwiseMax(-fit_reach).cwiseMin(fit_reach);
  ModelFit best = fit_from(model, z, centre, start);
  if (!thorough) return best;
  const std::size_t num_corners = std::size_t{1} << model.effects.size();
  for (std::size_t corner = 0; corner < num_corners; ++corner) {
    for (std::size_t k = 0; k < model.effects.size(); ++k) {
      const Eigen::Index i = model.num_parameters + static_cast<Eigen::Index>(k);
      const bool up = (corner >> k & 1) != 0;
      start[i] = up ? 0.5 * model.high[i] : model.low[i] < 0 ? 0.5 * model.low[i] : 0.1 * model.high[i];
    }
    ModelFit other = fit_from(model, z, centre, start);
    if (other.q < best.q) best = std::move(other);
  }
  return best;
}

Eigen::VectorXd predict(const SubModel& model, const Eigen::VectorXd& x) {
  return transposed_times(model.coefficients, features_of(x));
}

Eigen::VectorXd full_point(const Emulator& emulator, const SubModel& model, const Eigen::VectorXd& x) {
  Eigen::VectorXd full = Eigen::VectorXd::Zero(emulator.num_parameters() + emulator.num_effects());
  full.head(model.num_parameters) = x.head(model.num_parameters);
  for (std::size_t k = 0; k < model.effects.size(); ++k)
    full[model.num_parameters + model.effects[k]] = x[model.num_parameters + static_cast<Eigen::Index>(k)];
  return full;
}

double log_evidence(const ModelFit& fit, const SubModel& model, const Problem& problem) {
  // The prior of u and the volume of its posterior have the same powers of 2 pi; those of the strengths remain.
  double sum = -0.5 * fit.q;
  Eigen::MatrixXd curvature = inverse_symmetric(fit.spread);
  for (std::size_t k = 0; k < fit.effects.size(); ++k) {
    const CandidateEffect& e = problem.effects[static_cast<std::size_t>(fit.effects[k])];
    const double scale = e.inner(e.prior_scale), p = fit.x[model.num_parameters + static_cast<Eigen::Index>(k)] / scale;
    sum += -0.5 * p * p - std::log(scale) + (e.low >= 0 || e.high <= 0 ? std::numbers::ln2 : 0.0);
    const Eigen::Index i = model.num_parameters + static_cast<Eigen::Index>(k);
    curvature(i, i) += 1 / (scale * scale) - 1;
  }
  // Of the Gaussian about the best point only what lies in the range counts.
  const Eigen::MatrixXd spread = inverse_symmetric(curvature);
  const auto below = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  for (Eigen::Index i = model.num_parameters; i < fit.x.size(); ++i) {
    const double sd = std::sqrt(spread(i, i));
    sum += std::log(std::max(1e-6, below((model.high[i] - fit.x[i]) / sd) - below((model.low[i] - fit.x[i]) / sd)));
  }
  return sum + 0.5 * log_determinant_symmetric(spread);
}

Interval profile_interval(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                          const ModelFit& fit, std::size_t k) {
  constexpr double rise = 3.8415;
  const Eigen::Index i = model.num_parameters + static_cast<Eigen::Index>(k);
  const auto above = [&](double p) {
    Eigen::VectorXd x = fit.x;
    x[i] = p;
    x = minimise(model, z, centre, x, i);
    return look(model, z, centre, x, false).s - fit.q - rise;
  };
  const auto side = [&](double end) {
    if (above(end) < 0) return end;  // the range ends first
    double inside = fit.x[i], outside = end;
    for (int halving = 0; halving < 30; ++halving) {
      const double middle = 0.5 * (inside + outside);
      (above(middle) < 0 ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  return {side(model.low[i]), side(model.high[i])};
}

}  // namespace drumsweep
