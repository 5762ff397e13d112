#include "core/step/step_report.h"

#include <algorithm>
#include <cmath>

#include "core/parallel/parallel_for.h"
#include "core/solver/projected_gauss_seidel.h"

namespace drumsweep {

namespace {

/// Adds up the blocks, in their order. @return contacts that press
std::size_t put_overlaps(const std::vector<Overlaps>& blocks, StepReport& report) {
  std::array<std::uint64_t, Overlaps::num_bins> counts{};
  double sum = 0, most = 0, num = 0;
  std::size_t pressed = 0;
  for (const Overlaps& o : blocks) {
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += o.counts[k];
    sum += o.sum;
    most = std::max(most, static_cast<double>(o.max));
    num += o.num;
    pressed += o.num_pressed;
  }
  if (num == 0) return pressed;
  report.max_overlap = most;
  report.mean_overlap = sum / num;
  double below = 0;
  std::size_t bin = 0;
  while (below + static_cast<double>(counts[bin]) < 0.95 * num) below += static_cast<double>(counts[bin++]);
  const double part = (0.95 * num - below) / static_cast<double>(counts[bin]);
  report.overlap_95 = std::min(most, (static_cast<double>(bin) + part) / Overlaps::bins_per_diameter);
  return pressed;
}

}  // namespace

StepReport make_smooth_report(const World& world, const SmoothScratch& scratch, std::vector<Overlaps>& overlaps) {
  StepReport report;
  report.num_contacts = report.num_rows = scratch.overlaps.size();
  overlaps.resize(1);
  overlaps[0].clear(world.physics.material.diameter_m);
  for (const float overlap : scratch.overlaps) overlaps[0].add(overlap);
  put_overlaps(overlaps, report);
  return report;
}

StepReport make_report(const World& world, const Balls& balls, Workspace& work, int iterations) {
  const Assembly& a = work.assembly;
  StepReport report;
  report.iterations = iterations;
  report.residual = natural_map_residual(a.problem, work.threads, a.velocity);
  report.num_rows = report.residual.num_rows;

  // Overlaps, block by block.
  work.overlaps.resize(a.num_blocks());
  parallel_for(work.threads, a.num_blocks(), [&](std::size_t s) {
    Overlaps& overlaps = work.overlaps[s];
    overlaps.clear(world.physics.material.diameter_m);
    for (const ContactPacks* packs : {&a.problem.blocks[s].pairs, &a.problem.blocks[s].walls})
      for (const std::uint32_t p : packs->active)
        for (std::size_t lane = 0; lane < pack_width; ++lane) {
          if (packs->rows[p].bias[lane] == no_row) continue;
          overlaps.num_pressed += packs->impulse[p].normal[lane] > 0 ? 1 : 0;
          if (packs->rows[p].overlap[lane] > 0) overlaps.add(packs->rows[p].overlap[lane]);
        }
  });
  report.num_contacts = put_overlaps(work.overlaps, report);

  // Momentum: velocities from the final impulses applied at once, against those that the solver has changed many times.
  work.check.swap(work.assembly.velocity);
  load_velocities(balls, work.inverse_mass, work.threads, work.assembly);
  apply_impulses(a.problem, work.threads, work.assembly.velocity);
  work.check.swap(work.assembly.velocity);
  float most = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const float(&v)[3] = a.velocity[i].linear, (&c)[3] = work.check[i].linear;
    most =
        std::max(most, (v[0] - c[0]) * (v[0] - c[0]) + (v[1] - c[1]) * (v[1] - c[1]) + (v[2] - c[2]) * (v[2] - c[2]));
  }
  report.force_balance = std::sqrt(static_cast<double>(most));
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
  const auto num = static_cast<double>(num_);
  out.num_contacts = static_cast<std::size_t>(std::llround(static_cast<double>(sum_.num_contacts) / num));
  out.num_rows = static_cast<std::size_t>(std::llround(static_cast<double>(sum_.num_rows) / num));
  out.iterations /= num;
  out.residual.mean /= num;
  out.overlap_95 /= num;
  out.mean_overlap /= num;
  return out;
}

}  // namespace drumsweep
