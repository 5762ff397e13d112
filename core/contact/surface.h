/// How two surfaces act on each other: the law of all contacts between balls, or of all between balls and one wall.
#pragma once

#include "core/config/study.h"
#include "core/contact/contact_law.h"
#include "core/effects/cohesion.h"
#include "core/effects/friction_speed.h"

namespace drumsweep {

struct Surface {
  ContactLaw law;                ///< its stiffness belongs to a contact with reduced radius `reference`
  double reference = 0;          ///< R* of two balls of the mean diameter, or of one and the wall [m]
  bool sizes_differ = false;     ///< k grows with sqrt(R*), cohesion with R*
  double friction = 0;           ///< at rest
  FrictionSpeed friction_speed;  ///< how it falls with sliding speed
  double restitution = 0;        ///< of impacts; 0: solved together with everything else, see contact_law.h
  double rolling = 0, twisting = 0;
  Cohesion cohesion;

  /// @param reduced_radius  R* = Ra Rb / (Ra + Rb); of a ball at a wall its own radius [m]
  double stiffness(double reduced_radius) const;
  Cohesion cohesion_at(double reduced_radius) const;
};

Surface ball_surface(const Physics& physics);
Surface wall_surface(const Physics& physics);

}  // namespace drumsweep
