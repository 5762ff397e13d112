#include "core/step/step_report.h"

#include <algorithm>
#include <cmath>

#include "core/state/arrays.h"

namespace drumsweep {

namespace {

/// Overlaps of the contacts that press, in metres, over the mean diameter. Reorders them.
void add_overlaps(double diameter, std::vector<float>& pressed, StepReport& report) {
  if (pressed.empty()) return;
  double sum = 0;
  for (const float overlap : pressed) sum += overlap;
  const auto place = pressed.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(pressed.size() - 1));
  std::nth_element(pressed.begin(), place, pressed.end());
  report.overlap_95 = *place / diameter;
  report.max_overlap = *std::max_element(place, pressed.end()) / diameter;
  report.mean_overlap = sum / static_cast<double>(pressed.size()) / diameter;
}

}  // namespace

StepReport make_smooth_report(const World& world, const SmoothScratch& scratch, std::vector<float>& pressed) {
  StepReport report;
  report.num_contacts = report.num_rows = scratch.overlaps.size();
  pressed = scratch.overlaps;
  add_overlaps(world.physics.material.diameter_m, pressed, report);
  return report;
}

StepReport make_report(const World& world, const BallState& state, Workspace& work, int iterations) {
  const Assembly& a = work.assembly;
  StepReport report;
  report.iterations = iterations;
  report.num_rows = a.problem.rows.size();
  report.residual = natural_map_residual(a.problem, a.impulse, a.turn, a.velocity);

  work.pressed.clear();
  for (std::size_t i = 0; i < a.problem.rows.size(); ++i) {
    if (a.impulse[i][3] > 0) ++report.num_contacts;
    if (a.overlap[i] > 0) append(work.pressed, a.overlap[i]);
  }
  add_overlaps(world.physics.material.diameter_m, work.pressed, report);

  // Momentum: what each ball gained against the sum of its impulses, added up in another way than the solver does.
  const Balls& balls = state.balls;
  work.impulse_sum.assign(balls.size(), Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < a.problem.rows.size(); ++i) {
    const ContactRow& row = a.problem.rows[i];
    const Impulse &p = a.impulse[i], &n = row.normal;
    const Eigen::Vector3f impulse(p[0] + n[0] * p[3], p[1] + n[1] * p[3], p[2] + n[2] * p[3]);
    work.impulse_sum[row.a] += impulse;
    if (row.b < balls.size()) work.impulse_sum[row.b] -= impulse;
  }
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Float4& v = a.velocity[i].linear;
    const Eigen::Vector3d gained = Eigen::Vector3d(v[0], v[1], v[2]) - balls.velocity[i].cast<float>().cast<double>();
    report.force_balance =
        std::max(report.force_balance, (gained - work.inverse_mass[i] * work.impulse_sum[i].cast<double>()).norm());
  }
  return report;
}

void ReportMean::add(const StepReport& r) {
  num_ += 1;
  sum_.num_contacts += r.num_contacts;
  sum_.num_rows += r.num_rows;
  sum_.iterations += r.iterations;
  sum_.residual.max = std::max(sum_.residual.max, r.residual.max);
  sum_.residual.mean += r.residual.mean;
  sum_.max_overlap = std::max(sum_.max_overlap, r.max_overlap);
  sum_.overlap_95 += r.overlap_95;
  sum_.mean_overlap += r.mean_overlap;
  sum_.force_balance = std::max(sum_.force_balance, r.force_balance);
}

StepReport ReportMean::mean() const {
  StepReport out = sum_;
  if (num_ == 0) return out;
  out.num_contacts = static_cast<std::size_t>(std::llround(static_cast<double>(sum_.num_contacts) / num_));
  out.num_rows = static_cast<std::size_t>(std::llround(static_cast<double>(sum_.num_rows) / num_));
  out.iterations /= num_;
  out.residual.mean /= num_;
  out.overlap_95 /= num_;
  out.mean_overlap /= num_;
  return out;
}

}  // namespace drumsweep
