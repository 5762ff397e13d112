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

/// Balls and their contacts. A number for the wall that is not given is that of the balls.
struct MaterialConfig {
  double diameter_m = 0.010;
  double density_kg_m3 = 2500.0;
  double friction = 0.7;
  double wall_friction = not_given;
  double restitution = 0.0;  ///< Newton's e, of approaches faster than solver.impact_speed_m_s
  double wall_restitution = not_given;
  double stiffness_N_m15 = 25000.0;  ///< k of Hertz' law f = k (g^1.5 + c g^0.5 dg/dt), for balls of the mean diameter
  double damping_s = 0.02;           ///< c of the same
  double youngs_modulus_Pa = not_given;  ///< where given, k follows from it
  double poisson_ratio = 0.3;
  double wall_youngs_modulus_Pa = not_given;  ///< not given: a rigid wall
  double wall_poisson_ratio = 0.3;
};

/// What the plain model leaves out, each neutral by default. One entry of effect_catalogue() each; core/effects has the physics.
struct EffectsConfig {
  double rolling_friction = 0.0;
  double wall_rolling_friction = not_given;
  double twisting_friction = 0.0;
  double wall_twisting_friction = not_given;
  double cohesion_force_N = 0.0;
  double wall_cohesion_force_N = not_given;
  double cohesion_range_m = 0.0005;
  std::string size_distribution = "lognormal";
  double size_spread = 0.0;
  double size_cut = 2.5;
  double outlet_coating_m = 0.0;
  double drum_coating_m = 0.0;
  double dynamic_friction = not_given;
  double friction_speed_m_s = 0.1;
  double air_density_kg_m3 = 0.0;
  double drag_coefficient = 0.44;
  double texture_height_scale = 1.0;
};

struct StepConfig {
  std::string method = "nonsmooth";  ///< or "smooth": explicit Hertz-Mindlin forces, core/step/smooth_step.h
  double steps_per_contact = 25.0;   ///< smooth: time steps in the contact time of a collision at contact_speed_m_s
  double contact_speed_m_s = 1.0;
};

struct SolverConfig {
  double outer_step_s = 0.008;         ///< contact search and feed once per outer step
  std::int64_t sub_steps = 4;          ///< gaps and normals refreshed, solved and advanced this often per outer step
  std::int64_t iterations = 10;        ///< projected Gauss-Seidel passes per sub-step; 0 = "auto"
  double residual_target_m_s = 0.001;  ///< iterations = "auto" goes on to this mean residual ...
  std::int64_t max_iterations = 2000;  ///< ... or to this many passes
  double residual_limit_m_s = 0.02;    ///< a design whose mean residual is above it is untrusted
  double speculative_margin = 0.1;     ///< rows for gaps up to this fraction of the largest ball diameter
  double impact_speed_m_s = 0.05;      ///< a faster approach is an impact
  double stabilization_steps = 2.0;    ///< n_s: the least relaxation time of an overlap, in sub-steps
  bool warm_start = true;
};

/// What every scene needs: balls, contacts, effects and how they are computed.
struct Physics {
  std::int64_t seed = 1;
  MaterialConfig material;
  EffectsConfig effects;
  StepConfig step;
  SolverConfig solver;
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
  double replicate = 0;  ///< whole number; 0 has the study's random streams, others their own after the warm drum
};

struct ObjectiveConfig {
  std::string window = "belt";          ///< or "footprint": what counts in f_m; results hold both
  std::string weights = "decaying";     ///< 2^-(n-1); "growing" = 2^(n-1) as printed in S1; "uniform" = 1
  std::string normalization = "modes";  ///< divide by N; "samples": by 2 N
  std::int64_t modes = 0;               ///< lowest modes that f sums and divides by; 0: all N
  double cell_diameters = 2.5;          ///< bed cell, in ball diameters
  double packing = 0.7;
  double friction_angle_deg = 35.0;
};

/// One axis of a grid, one column of a list of points, or one range to search in.
struct StageVariable {
  std::string key;                ///< any numeric key of the study, e.g. "outlet.base_width_m"
  double from = not_given;        ///< grid, searches
  double to = not_given;          ///< grid, searches
  std::int64_t count = 1;         ///< grid
  std::vector<double> values;     ///< points
  double resolution = not_given;  ///< searches: designs lie on from + whole multiples; not given: 1/200 of the range
};

/// What a stage asks for. "grid": all combinations; "points": the i-th values together. The others ("zoom", "adaptive",
/// "refine", "replicate") decide from the results of all earlier stages, see sweep/plan/planner.h.
struct StageConfig {
  std::string name;
  std::string type = "grid";
  std::vector<StageVariable> variables;  ///< a search without any has the ranges of the earlier stages

  std::int64_t nodes = 5;  ///< zoom: along each variable
  double margin = 0.25;  ///< zoom: the region is larger than that of the optimum, by this share of its size at each end
  std::int64_t budget = 40;     ///< adaptive: designs, the initial ones included
  std::int64_t initial = 12;    ///< adaptive: spread evenly before the first fit; results of earlier stages count
  std::int64_t batch = 4;       ///< adaptive: designs chosen together from one fit
  double least_gain_m = 0;      ///< adaptive: ends before its budget when a batch is expected to lower f by less
  std::int64_t designs = 1;     ///< replicate: the optimum of the fit, then the best that have been simulated
  std::int64_t replicates = 4;  ///< replicate: of each
  double turns = not_given;     ///< replicate: recorded, instead of record.turns
  std::string file{};           ///< points: CSV file that has them; empty once it has been read
};

/// How stages of type "refine" search, and what the study reports about its optimum.
struct RefineConfig {
  std::string method = "bobyqa";
  std::int64_t starts = 4;            ///< searches side by side, from different designs
  std::int64_t max_evaluations = 25;  ///< of each start
  double tolerance_steps = 1.0;       ///< a start ends when its steps are this small, in units of the resolution
  bool only_if_smooth = true;         ///< else the optimiser starts whatever the gate says
  double tolerance_f_m = 0.0;         ///< reported: is f below it?
};

struct Study : Physics {
  std::string name = "study";
  DrumConfig drum;
  OutletConfig outlet;
  BeltConfig belt;
  FeedConfig feed;
  WarmupConfig warmup;
  RecordConfig record;
  ObjectiveConfig objective;
  RefineConfig refine;
  std::vector<StageConfig> stages;
};

}  // namespace drumsweep
