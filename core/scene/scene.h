/// Scenes: small experiments with known answers, each one a class with its keys, its build -> run -> observables.
///
/// To add one: a class here beside the others (core/scene/NAME.{h,cc}), a line in scene_types() and a file in schedules/scenes.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/config/field_table.h"
#include "core/scene/observable.h"
#include "core/step/stepper.h"

namespace drumsweep {

struct SceneProgress {
  const char* what;      ///< "pouring", "turning" ...
  double time_s, end_s;  ///< simulated, and planned at most
  std::size_t balls;
};
/// Called now and then; return false to stop the scene there.
using SceneObserver = std::function<bool(const SceneProgress&)>;

/// Numbers over time or along a line, for HDF5 and figures.
struct Series {
  std::string name;                  ///< "velocity_profile"
  std::vector<std::string> columns;  ///< names with unit, "y [m]"
  std::vector<double> values;        ///< (rows x columns)
};

struct SceneResult {
  std::vector<Observable> observables;
  std::vector<Series> series;
  BallState state;                       ///< at the end
  std::vector<TriangleMesh> walls;       ///< those that are there at the end, in the room, without their borders
  StepReport quality;                    ///< means over all steps (ReportMean)
  std::int64_t num_balls = 0, lost = 0;  ///< put in; found where none can be
  double simulated_s = 0, cpu_s = 0;
  bool stopped = false;  ///< by the observer; the rest is then incomplete
};

class Scene {
 public:
  int threads = 1;  ///< of the run; results do not depend on it

  virtual ~Scene() = default;
  /// The keys of the [scene] table beside `type`.
  virtual void add_fields(FieldTable& table) = 0;
  /// What its keys and the physics must satisfy together. @throws InputError with where(key) first
  virtual void validate(const Physics& physics, const Where& where) const = 0;
  virtual SceneResult run(const Physics& physics, const SceneObserver& observer) const = 0;
};

struct SceneType {
  const char* name;
  const char* about;  ///< one line
  std::unique_ptr<Scene> (*make)();
};
std::span<const SceneType> scene_types();

/// A scene file: [scene] type = ..., its keys, and the tables of Physics.
struct SceneFile {
  std::string name, type;
  Physics physics;
  std::unique_ptr<Scene> scene;
};

/// Whether the text has a [scene] table, so that it is a scene and not a study. @throws InputError
bool is_scene_file(const std::string& path);

/// @throws InputError: unknown type or key with "did you mean", wrong type or range, or what the scene cannot do
/// @param changes  of the command line: "scene.fill=0.3"
SceneFile read_scene(const std::string& path, const std::vector<std::string>& changes = {});
SceneFile parse_scene(const std::string& text, const std::string& source);

/// All keys of a scene file with their values, as TOML; with help and ranges as comments when `comments`.
std::string write_scene(SceneFile& file, bool comments);

}  // namespace drumsweep
