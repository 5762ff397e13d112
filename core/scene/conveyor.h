/// The bed on the belt, ball by ball: balls fall from a line across a moving belt, spread and slide as friction and rolling
/// resistance let them, and leave at its end. It judges the cellular automaton that postproc/bed.h has in place of all this.
///
/// The belt runs along +x in the plane z = 0, y in [0, width]; the source is above x = 0. A bed that moves with the belt has the
/// mean height  rate / (density x packing x width x belt speed)  where heights are volume over packing and area, as those of
/// S1's cells are (S1, section 2).
#pragma once

#include "core/scene/scene.h"
#include "core/state/landing.h"

namespace drumsweep {

struct ConveyorScene : Scene {
  double width_m = 0.30;  ///< of the belt, across
  double belt_speed_m_s = 0.25;
  double length_m = 0.60;        ///< from the source to the end, where balls leave
  double measure_from_m = 0.30;  ///< the bed is measured from there to the end
  std::string edge = "skirt";    ///< or "open": balls may fall over the edges
  double skirt_friction = 0.0;   ///< of the standing skirts
  double feed_rate_kg_s = 1.3;
  double drop_height_m = 0.05;    ///< of the source over the belt
  double exit_speed_m_s = 0.5;    ///< downwards, at the source
  double source_length_m = 0.06;  ///< along the belt
  double band_begin_m = 0.0;      ///< the band is even from here ...
  double band_end_m = 0.30;       ///< ... to here, across the belt
  double heap_share = 0.0;        ///< of the balls, which fall on a heap instead
  double heap_at_m = 0.15;        ///< its middle, across the belt
  double heap_width_m = 0.01;     ///< its standard deviation
  double measure_s = 4.0;
  double cell_m = 0.025;  ///< of the profiles, across; adjusted to divide the width
  double packing = 0.7;   ///< volume heights are balls' volume over this and the area

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;

  int num_cells() const;
  /// Places where the balls would touch the bare belt, from the series "landings" of a result; ball ids in the order of release.
  static std::vector<Landing> landings(const SceneResult& result);
};

}  // namespace drumsweep
