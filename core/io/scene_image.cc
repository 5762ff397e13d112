#include "core/io/scene_image.h"

#include <fmt/format.h>

#include <map>

#include "core/io/hdf5_image.h"

namespace drumsweep {
namespace {

std::vector<double> flat(const std::vector<Eigen::Vector3d>& vectors) {
  std::vector<double> out;
  out.reserve(3 * vectors.size());
  for (const Eigen::Vector3d& v : vectors) out.insert(out.end(), {v[0], v[1], v[2]});
  return out;
}

}  // namespace

std::string pack_scene(SceneFile& file, const SceneResult& r) {
  Hdf5Writer out;
  out.attribute("scene", write_scene(file, false));
  out.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  out.attribute("simulated_s", r.simulated_s);
  out.attribute("num_balls", r.num_balls);
  out.attribute("lost", r.lost);
  out.attribute("residual_mean_m_s", r.quality.residual.mean);
  out.attribute("residual_max_m_s", r.quality.residual.max);
  out.attribute("overlap_mean", r.quality.mean_overlap);
  out.attribute("overlap_95", r.quality.overlap_95);
  out.attribute("overlap_max", r.quality.max_overlap);
  out.attribute("force_balance_m_s", r.quality.force_balance);
  out.attribute("state_hash", fmt::format("{:016x}", state_hash(r.state)));
  // Those of one name are rows of one array.
  std::map<std::string, std::vector<double>> rows;
  std::map<std::string, const Observable*> first;
  for (const Observable& o : r.observables) {
    rows[o.name].insert(rows[o.name].end(), {o.position, o.value, o.sigma});
    first.try_emplace(o.name, &o);
  }
  for (const auto& [name, values] : rows)
    out.dataset("observables/" + name, values, 3, first[name]->unit,
                "position [" + first[name]->position_unit + "], value, standard error");
  for (const Series& s : r.series)
    out.dataset("series/" + s.name, s.values, s.columns.size(), "in the columns",
                fmt::format("columns: {}", fmt::join(s.columns, ", ")));
  out.dataset("balls/position", flat(r.state.balls.position), 3, "m", "centres");
  out.dataset("balls/velocity", flat(r.state.balls.velocity), 3, "m s-1", "");
  out.dataset("balls/spin", flat(r.state.balls.spin), 3, "rad s-1", "");
  out.dataset("balls/radius", r.state.balls.radius, 1, "m", "");
  out.dataset("balls/id", r.state.balls.id, 1, "1", "");
  out.dataset("balls/fixed", r.state.balls.exit, 1, "1", "254: a ball that never moves");
  return out.seal("scene", 1);
}

}  // namespace drumsweep
