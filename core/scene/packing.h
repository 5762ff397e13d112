/// Balls settle in a box until they are at rest: packing fraction, coordination, forces on floor and walls.
///
/// At rest floor and walls together carry the weight. Frictionless rigid balls at rest have as many contacts as degrees of freedom,
/// 3 N (isostatic; Moukarzel 1998, Silbert et al. 2002): 2 x contacts / N = 6, contacts with walls counted whole. Under gravity
/// that holds with rattlers (each lies on 3 contacts) and without them. Soft balls have more contacts: 7.7 sqrt(excess packing
/// fraction) (O'Hern et al. 2003), and the excess is about 3 x packing x overlap/d; so light loads or stiff balls come near 6.
/// Friction lowers the number, down to 4.
///
/// A rattler is a ball that no other presses down and that lies on three contacts at most: it bears nothing but itself. (With a
/// fourth it may be part of an arch.)
///
/// A contact counts when it carries more than `contact_force_fraction` of the mean normal force: unlike its overlap, that tells a
/// contact from a near miss at the accuracy of the solver.
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct PackingScene : Scene {
  double width_m = 0.08;  ///< along x
  double depth_m = 0.08;  ///< along y
  bool periodic = false;  ///< along y, instead of walls there
  std::int64_t num_balls = 700;
  double shake_m_s = 0.3;         ///< random velocities at the beginning, which undo the lattice they start on
  double rest_speed_m_s = 1e-4;   ///< root mean square of the balls' speeds at rest
  double max_settle_s = 5.0;      ///< gives up waiting after this
  double measure_s = 0.2;         ///< averages over this time at rest
  double margin_diameters = 2.0;  ///< of walls, floor and free surface, which the bulk keeps away from
  double contact_force_fraction = 1e-3;

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep
