/// A heap of balls on the ground, and its angle of repose.
///
/// Protocols: "pour" lets balls fall slowly from a source that keeps its height over the apex (or over the ground); "lifted_cylinder"
/// pulls a filled tube up, which gives flatter heaps that depend on lifting speed and fill: it measures the protocol as much as the
/// material. On a "disc" what rolls over the edge is taken away, so the cone is as wide as the disc and pouring goes on until the heap
/// grows no more; on a "plane" the mass is given and the heap chooses its width. A "rough" base is a layer of glued balls.
///
/// Angle of repose: straight line, by least squares, through the azimuthally averaged surface between 20 % and 80 % of its height
/// over the base; that leaves out the rounded apex and the foot. Its standard error is that of the mean of eight sectors fitted
/// apart. The volume under the surface gives a second angle, tan(theta) = 3 V / (pi R^3), that of the cone of equal volume on the
/// same base. Rolling resistance is what holds a heap of balls up: with it as a constraint the heap is static, which the
/// observables residual_kinetic_energy and creep show.
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct PileScene : Scene {
  std::string base = "rough";
  std::string shape = "disc";
  std::string protocol = "pour";
  double base_radius_m = 0.13;  ///< of the disc; on a plane what rolls out further is taken away
  double mass_kg = not_given;   ///< to pour, or in the cylinder; disc, poured: until the heap grows no more
  double rate_kg_s = 0.3;
  std::string source = "rising";
  double source_height_m = 0.04;  ///< over the apex (rising) or the ground (fixed)
  double source_radius_m = 0.026;
  double cylinder_radius_m = 0.06;
  double lift_speed_m_s = 0.02;
  double longest_settling_s = 3;

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep
