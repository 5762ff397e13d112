/// A study as plain structs: what the user writes in a TOML file, with defaults, in the units that the key names carry.
/// Read once by read_study(), passed as const&, stored with the result. The list of keys, their ranges and their help
/// is in schema.cc and nowhere else.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace drumsweep {

/// Marks an optional number that the study file does not give.
inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

/// Bumps of agglomerated fines on the inside of drum and outlet (S1, section 2).
struct TextureConfig {
  double density_1_m2 = 700.0;
  double height_min_m = 0.002;
  double height_max_m = 0.008;
  double width_min_m = 0.005;
  double width_max_m = 0.020;
  std::string width_is =
      "sigma";  ///< S1 says "width" of a Gaussian: its standard deviation, or twice that ("two_sigma")
};

struct DrumConfig {
  double diameter_m = 0.75;
  double length_m = 2.5;
  double inclination_deg = 7.5;
  double angular_velocity_rad_s = 2.5;
  double mesh_resolution_m = 0.01;
  TextureConfig texture;
};

/// Outlet with slots that widen downhill. Exactly one of the two opening angles is given: the unit of S1 is open.
struct OutletConfig {
  double length_m = 0.75;
  double opening_angle_deg = not_given;
  double opening_angle_rad = not_given;
  double base_width_m = 0.048;
  std::int64_t num_slots = 3;
  double bisector_angle_deg = 15.0;
  std::string bisector_sense = "with_rotation";  ///< or "against_rotation"; S1's figure is not available
  std::string distance_along = "axis";           ///< or "bisector": what s in w(s) = base + 2 s tan(angle/2) runs along
};

struct BeltConfig {
  double width_m = 1.0;
  double speed_m_s = 0.25;
  double outlet_begin_m = 0.15;  ///< y_1 of S1: where the outlet begins, measured from the belt's edge
  double drop_height_m = 0.05;   ///< belt below the outlet's lowest point
  std::string edge = "skirt";    ///< or "open": what lands past an edge is spilled
};

struct FeedConfig {
  double rate_kg_s = 4.4;
  double zone_begin_m = 0.05;   ///< from the back plate, along the axis
  double zone_length_m = 0.20;  ///< along the axis
  double zone_width_m = 0.30;   ///< across, centred under the axis
};

struct MaterialConfig {
  double diameter_m = 0.010;
  double density_kg_m3 = 2500.0;
  double friction = 0.7;
  double stiffness_N_m15 = 25000.0;  ///< k of Hertz' law f = k (g^1.5 + c g^0.5 dg/dt)
  double damping_s = 0.02;           ///< c of the same
};

struct SolverConfig {
  double outer_step_s = 0.004;       ///< contact search and feed once per outer step
  std::int64_t sub_steps = 2;        ///< gaps and normals refreshed, solved and advanced this often per outer step
  std::int64_t iterations = 5;       ///< projected Gauss-Seidel passes per sub-step
  double speculative_margin = 0.1;   ///< rows for gaps up to this fraction of the largest ball diameter
  double impact_speed_m_s = 0.05;    ///< a faster approach is an impact (zero restitution)
  double stabilization_steps = 2.0;  ///< n_s: the least relaxation time of an overlap, in sub-steps
  bool warm_start = true;
};

struct WarmupConfig {
  double window_turns = 2.0;             ///< inflow and outflow are compared over windows of whole turns
  double tolerance = 0.03;               ///< |in - out| <= tolerance * in ...
  std::int64_t windows = 2;              ///< ... in this many windows in a row
  double max_turns = 40.0;               ///< gives up waiting (and says so) after this many
  double opening_angle_deg = not_given;  ///< outlet used in the warm-up; not given: the study's [outlet]
  double opening_angle_rad = not_given;
  double base_width_m = not_given;
};

struct RecordConfig {
  double adapt_turns = 4.0;
  double turns = 2.0;
};

struct ObjectiveConfig {
  std::string window = "belt";          ///< or "footprint": what counts in f_m; results hold both
  std::string weights = "decaying";     ///< 2^-(n-1); "growing" = 2^(n-1) as printed in S1; "uniform" = 1
  std::string normalization = "modes";  ///< divide by N; "samples": by 2 N
  double cell_diameters = 2.5;          ///< bed cell, in ball diameters
  double packing = 0.7;
  double friction_angle_deg = 35.0;
};

/// One axis of a grid, or one column of a list of points.
struct StageVariable {
  std::string key;             ///< any numeric key of the study, e.g. "outlet.base_width_m"
  double from = not_given;     ///< grid
  double to = not_given;       ///< grid
  std::int64_t count = 1;      ///< grid
  std::vector<double> values;  ///< points
};

struct StageConfig {
  std::string name;
  std::string type = "grid";  ///< "grid": all combinations; "points": the i-th values together
  std::vector<StageVariable> variables;
};

struct Study {
  std::string name = "study";
  std::int64_t seed = 1;
  DrumConfig drum;
  OutletConfig outlet;
  BeltConfig belt;
  FeedConfig feed;
  MaterialConfig material;
  SolverConfig solver;
  WarmupConfig warmup;
  RecordConfig record;
  ObjectiveConfig objective;
  std::vector<StageConfig> stages;
};

}  // namespace drumsweep
