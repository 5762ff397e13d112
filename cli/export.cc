/// drumsweep export
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/moment.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/export/mesh_files.h"
#include "postproc/export/paraview_script.h"
#include "postproc/export/trajectory.h"
#include "postproc/export/vtkhdf.h"
#include "postproc/objective.h"
#include "sweep/stop.h"
#include "sweep/store/recordings.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct ExportArguments {
  MomentOptions moment;
  std::string format, folder;
};

/// Files into the folder, with their names remembered.
class Folder {
 public:
  explicit Folder(const std::string& path) : path_(std::filesystem::path(path).lexically_normal().string()) {
    make_folder(path_);
  }
  void write(const std::string& name, const std::string& bytes) {
    write_durably(path_ + "/" + name, bytes);
    names_.push_back(name);
  }
  const std::string& path() const { return path_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::string path_;
  std::vector<std::string> names_;
};

/// Balls and walls of one or more moments, as they are wanted.
class Collector {
 public:
  void add(const Still& still) {
    balls_.add(still.time_s, still.balls);
    for (const Still::Wall& wall : still.walls) walls_[wall.name].add(still.time_s, wall.mesh);
  }
  void write(Folder& folder) const {
    folder.write("balls.h5", balls_.h5());
    folder.write("balls.xmf", balls_.xmf("balls.h5"));
    for (const auto& [name, wall] : walls_) {
      folder.write(name + ".h5", wall.h5());
      folder.write(name + ".xmf", wall.xmf(name + ".h5"));
    }
  }

 private:
  Trajectory balls_;
  std::map<std::string, WallTrajectory> walls_;
};

void write_moment(const Still& still, const std::string& format, Folder& folder) {
  if (format == "xdmf") {
    Collector collector;
    collector.add(still);
    collector.write(folder);
    return;
  }
  if (format == "vtkhdf") folder.write("balls.hdf", vtkhdf_balls(still.balls));
  for (const Still::Wall& wall : still.walls) {
    const std::string name = wall.name + "." + (format == "vtkhdf" ? "hdf" : format);
    if (format == "vtkhdf")
      folder.write(name, vtkhdf_mesh(wall.mesh));
    else
      folder.write(name, format == "stl" ? stl_file(wall.mesh, wall.name) : obj_file(wall.mesh, wall.name));
  }
}

/// The recorded landings of a folder's design as points on the moving belt; nothing where it has none yet.
void write_landings(const ExportArguments& options, const Moment& moment, Folder& folder) {
  if (!moment.design) return;
  const Study study = read_frozen_study(options.moment.path);
  const StoredDesign stored = read_design({options.moment.path}, study, *moment.design);
  if (!stored.recording || stored.recording->landings.empty()) {
    fmt::print(stderr, "drumsweep: design {} has no recorded landings (yet)\n", moment.design->id);
    return;
  }
  const Recording& recording = *stored.recording;
  const DrumModel model(moment.drum->study, moment.drum->outlet);
  const double speed = model.study.belt.speed_m_s;
  const double duration = duration_of_turns(recording.turns, model.study.drum);
  const auto at = [&](double time, std::vector<float>& landed_s) {
    return landed_balls(recording.landings, time, speed, model.belt_height, landed_s);
  };
  std::vector<float> landed_s;
  if (options.format == "vtkhdf") {
    const Balls balls = at(recording.begin_s + duration, landed_s);
    folder.write("landings.hdf", vtkhdf_balls(balls, landed_s));
    return;
  }
  Trajectory points(Trajectory::Kind::landings);
  const int frames = options.moment.frames > 1 ? options.moment.frames : 24;
  for (int i = 1; i <= frames; ++i) {
    const double time = recording.begin_s + duration * i / frames;
    const Balls balls = at(time, landed_s);
    if (balls.size() > 0) points.add(time, balls, landed_s);
  }
  folder.write("landings.h5", points.h5());
  folder.write("landings.xmf", points.xmf("landings.h5"));
}

const char* const how_to_open =
    "In ParaView: open balls.xmf (and drum.xmf, belt.xmf, landings.xmf); of the readers offered take \"XDMF Reader\"; "
    "Apply.\n"
    "Filter Glyph: Glyph Type Sphere, Orientation Array none, Scale Array diameter_m, Scale Factor 1, Glyph Mode All "
    "Points;\n"
    "each ball then has its size. Colour by speed_m_s [m/s], slot (0 inside, 1 ... slot, 255 over the end) or "
    "others.\n";

void say(const Folder& folder, const Moment& moment, const std::string& format) {
  fmt::print("{}: {}\n", folder.path(), moment.text);
  for (const std::string& name : folder.names()) fmt::print("  {}\n", name);
  if (format == "xdmf")
    fmt::print("{}The same at once: paraview --script={}/open_in_paraview.py\n", how_to_open, folder.path());
  if (format == "vtkhdf")
    fmt::print(
        "In ParaView: open balls.hdf and the walls (\"VTKHDF Reader\"); then as for XDMF, see `drumsweep export "
        "--help`.\n");
}

int export_moment(const ExportArguments& options) {
  install_stop_signals();
  const bool meshes_only = options.format == "stl" || options.format == "obj";
  const bool several = options.moment.frames > 1;
  if (several && options.format != "xdmf")
    throw InputError(
        fmt::format("--frames {}: --format {} holds one moment (ParaView 5.11 reads no series of it); use "
                    "--format xdmf",
                    options.moment.frames, options.format));
  if (options.moment.seconds && !several) throw InputError("--seconds: needs --frames 2 or more");
  const Moment moment = read_moment(options.moment);
  const double lead = meshes_only && !options.moment.lead_s ? 0 : lead_of(options.moment, moment, several);
  Reporter reporter;
  Collector collector;
  std::optional<Still> still;
  bool ended = true;
  if (several)
    ended = film(moment, lead, options.moment, reporter, [&](const Still& at, double) { collector.add(at); });
  else
    ended = (still = still_after_lead(moment, lead, reporter)).has_value();
  if (!ended) {
    fmt::print(stderr, "drumsweep: stopped by {}; nothing was written\n", stop_signal());
    return exit_stopped;
  }
  Folder folder(options.folder);
  if (several)
    collector.write(folder);
  else
    write_moment(*still, options.format, folder);
  if (!meshes_only) write_landings(options, moment, folder);
  if (options.format == "xdmf") folder.write("open_in_paraview.py", paraview_script);
  say(folder, moment, options.format);
  return exit_done;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "States, trajectories, landings and walls for ParaView and CAD.");
  add_moment_options(*command, options->moment);
  command
      ->add_option("--format", options->format,
                   "xdmf: balls, walls and landings, over time too; vtkhdf: the same at one moment; stl (binary), obj: "
                   "walls")
      ->required()
      ->check(CLI::IsMember({"xdmf", "vtkhdf", "stl", "obj"}));
  command->add_option("-o,--output", options->folder, "folder; made if need be, files of the same name are replaced")
      ->required();
  command
      ->add_option("--frames", options->moment.frames,
                   "xdmf: moments of a trajectory, the simulation going on from the state [default: the state alone]")
      ->check(CLI::Range(1, 5000));
  command->footer(
      std::string(
          "Examples:\n"
          "  drumsweep export out/warm_state.h5 --format xdmf -o view             the stored state\n"
          "  drumsweep export out --format xdmf -o view --frames 50 --seconds 2   the best design, 2 s of it\n"
          "  drumsweep export out --at 3,0.035 --format stl -o cad                drum with that outlet, belt\n"
          "  drumsweep export pile/pile.h5 --format vtkhdf -o view                a scene\n"
          "Lengths in metres, z up, x along the belt, y across it from its edge. Arrays: velocity_m_s, "
          "spin_rad_s, diameter_m,\n"
          "speed_m_s, id, slot; landings (of a folder's design, carried along by the belt): landed_s instead of "
          "spin. Walls are\n"
          "surfaces without thickness, normals towards the balls: not watertight.\n") +
      how_to_open);
  command->callback([options, &exit_code] { exit_code = export_moment(*options); });
}

}  // namespace drumsweep
