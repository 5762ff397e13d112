#include "core/io/scene_image.h"

#include <fmt/format.h>

#include <map>

#include "core/io/h5md.h"

namespace drumsweep {
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
    out.dataset("drumsweep/observables/" + name, values, 3, first[name]->unit,
                "position [" + first[name]->position_unit + "], value, standard error");
  for (const Series& s : r.series)
    out.dataset("drumsweep/series/" + s.name, s.values, s.columns.size(), "in the columns",
                fmt::format("columns: {}", fmt::join(s.columns, ", ")));
  write_h5md(out, r.state.balls, file.physics.material, r.state.num_steps, r.simulated_s);
  return out.seal("scene", 2);
}

}  // namespace drumsweep
