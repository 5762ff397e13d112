/// What columns and silos are filled with.
#pragma once

#include "core/config/study.h"

namespace drumsweep {

/// Glass beads, 1 cm so that a time step is a small part of sqrt(d/g): run-out over length knows no size.
inline Physics glass_beads(bool fine) {
  Physics p;
  p.material.diameter_m = 0.01;
  p.material.density_kg_m3 = 2500;
  p.material.friction = 0.5;
  p.material.restitution = 0.5;
  p.material.stiffness_N_m15 = 1e6;
  p.material.damping_s = 0.0005;
  p.solver.outer_step_s = fine ? 0.002 : 0.004;
  p.solver.sub_steps = 2;
  p.solver.iterations = fine ? 30 : 15;
  return p;
}

}  // namespace drumsweep
