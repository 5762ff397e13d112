#include "postproc/still.h"

#include <utility>

#include "core/geometry/primitives.h"

namespace drumsweep {

Still still_of(const DrumModel& model, const DrumState& state, double belt_height) {
  const Study& study = model.study;
  Still still{study.name, time_of(model, state.num_steps), state.balls, {}, {}};
  const Pose pose = model.pose(still.time_s);
  still.walls.push_back({"drum", placed(model.mesh(), pose)});
  const auto [begin, end] = belt_piece(study);
  TriangleMesh belt;
  add_plate(belt, {begin, 0, belt_height}, {end - begin, 0, 0}, {0, study.belt.width_m, 0});
  still.walls.push_back({"belt", std::move(belt)});
  const Eigen::Vector3d axis = model.tilt.col(2);
  still.drum =
      Still::Drum{pose.origin - axis * study.drum.length_m, pose.origin, pose.origin + axis * model.wall.outlet.length,
                  model.wall.outlet.radius, model.wall.outlet.num_slots};
  return still;
}

Still still_of(const Discharge& discharge) {
  return still_of(discharge.model(), discharge.state(), discharge.belt_height());
}

Still still_of(StoredScene scene) {
  Still still{scene.name, scene.time_s, std::move(scene.balls), {}, {}};
  for (TriangleMesh& mesh : scene.walls)
    still.walls.push_back(
        {scene.walls.size() == 1 ? "wall" : "wall" + std::to_string(still.walls.size() + 1), std::move(mesh)});
  return still;
}

}  // namespace drumsweep
