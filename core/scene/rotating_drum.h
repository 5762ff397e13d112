/// A rotating drum: a slice that is periodic along the axis, a drum with end walls that turn with it, or an inclined one that is fed at
/// its upper end and open at its lower one.
///
/// The axis runs along room y; an inclination tilts gravity, not the drum: (0, g sin, -g cos). The wall turns about +y, so it carries
/// the bed up on the side of -x and the free surface falls towards +x. All profiles are taken in a plane across the axis: of the whole
/// length where it is periodic, of the middle half where it has ends.
///
/// What is read off, from volumes and velocities of the balls on a grid of quarter diameters, averaged over each time block:
///   free surface   where the solid fraction, averaged over a diameter (centres of balls count), falls below 0.3, half that of a bed
///   charge angle   of the straight line fitted to the free surface in the central half of its chord (columns one diameter
///                  wide); theta > 0 when it falls towards +x. The S of a fast drum bends outside that half.
///   mass centre angle   between the vertical and the line from the axis to the centre of mass: the same angle for a straight surface
///   velocity profile   u along the surface, down-slope positive, over y along the normal n through the axis; y = n.r, so the axis is at 0
///                  and the wall under the bed at -R, as Alizadeh, Bertrand and Chaouki (2013) have it. In a strip two diameters
///                  to both sides of the normal, in bins of half a diameter; the room's frame, not the wall's.
///   surface velocity   u at the free surface on the normal; zero-velocity position: y at which u changes sign
/// Errors: from eight time blocks. A turn or more in each makes them independent; in a short run they are a lower bound.
///
/// Fed: balls begin at rest at the height of the axis. Residence time is that of the balls that leave while recording; in a steady
/// state holdup = feed rate times residence time, and outflow_over_feed = 1.
#pragma once

#include "core/config/study.h"
#include "core/scene/scene.h"

namespace drumsweep {

struct RotatingDrumScene : Scene {
  double diameter_m = 0.3;
  double length_m = 0.06;
  double inclination_deg = 0;
  double angular_velocity_rad_s = 2.0;
  std::string ends = "periodic";  ///< or "walls", "open_fed"
  double fill = not_given;        ///< part of the cross-section that the bed takes at fill_packing
  double fill_packing = 0.6;
  std::int64_t num_balls = 0;  ///< instead of `fill`
  double feed_kg_s = not_given;
  double feed_zone_length_m = 0.05;  ///< from the upper end
  double feed_zone_width_m = 0.05;   ///< across
  double mesh_resolution_m = 0.005;
  TextureConfig texture{.density_1_m2 = 0};
  double settle_turns = 1;
  double record_turns = 2;

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep
