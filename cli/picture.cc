/// drumsweep picture
#include "postproc/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/moment.h"
#include "core/config/schema.h"
#include "postproc/animation.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

struct PictureArguments {
  MomentOptions moment;
  PictureOptions picture;
  std::string file, size, view, colour;
  bool animate = false;
};

/// "640x480". @throws InputError
void set_size(const std::string& text, PictureOptions& picture) {
  char x = 0;
  int used = 0;
  const auto fits = [](int pixels) { return pixels >= 160 && pixels <= 8000; };
  if (std::sscanf(text.c_str(), "%5d%c%5d%n", &picture.width, &x, &picture.height, &used) != 3 || x != 'x' ||
      static_cast<std::size_t>(used) != text.size() || !fits(picture.width) || !fits(picture.height))
    throw InputError(fmt::format("--size {}: accepted is WIDTHxHEIGHT in pixels, 160 to 8000 each", text));
}

int stopped() {
  fmt::print(stderr, "drumsweep: stopped by {}; nothing was written\n", stop_signal());
  return exit_stopped;
}

int animate(PictureArguments options, const Moment& moment, double lead) {
  Reporter reporter;
  options.picture.soft_shadows = false;
  Animation animation(options.file, options.picture);
  const double interval = frame_interval(options.moment, moment);
  if (!film(moment, lead, options.moment, reporter, [&](const Still& still, double time) {
        animation.add(still, fmt::format("{}, t = {:.2f} s", still.name, time));
      }))
    return stopped();
  // In real time where the eye can follow that.
  const double rate = std::clamp(1 / interval, 8.0, 30.0);
  animation.write(rate);
  fmt::print("{} ({}; {} frames, {} {:.2f} s of simulated time, shown at {:.2g} times real speed)\n", options.file,
             moment.text, options.moment.frames, "every", interval, rate * interval);
  return exit_done;
}

int picture(PictureArguments options) {
  install_stop_signals();
  if (!options.animate && !options.file.ends_with(".png"))
    throw InputError(options.file + ": unknown ending, accepted: .png, or with --animate .gif and .mp4");
  need_place_for(options.file);
  set_size(!options.size.empty() ? options.size : options.animate ? "640x480" : "1400x900", options.picture);
  Moment moment = read_moment(options.moment);
  const bool of_drum_animated = options.animate && moment.drum;
  options.picture.colour = !options.colour.empty() ? options.colour : moment.drum ? "speed" : "height";
  options.picture.view = !options.view.empty() ? options.view : of_drum_animated ? "outlet" : "all";
  const double lead = lead_of(options.moment, moment, options.animate);
  if (options.animate) return animate(options, moment, lead);

  if (options.moment.seconds) throw InputError("--seconds: is for --animate; --lead simulates before a picture");
  need_povray();
  Reporter reporter;
  const std::string text = moment.text;
  const std::optional<Still> still = still_after_lead(std::move(moment), lead, reporter);
  if (!still) return stopped();
  try {
    write_picture(*still, options.picture, options.file);
  } catch (const std::exception&) {
    if (!stop_requested()) throw;
    return stopped();
  }
  fmt::print("{} ({})\n", options.file, text);
  return exit_done;
}

}  // namespace

void add_picture(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<PictureArguments>();
  options->moment.frames = 48;
  CLI::App* command = app.add_subcommand(
      "picture", "Render a stored drum or scene: balls and walls, cut open on the near side; or film its discharge.");
  add_moment_options(*command, options->moment);
  command->add_option("-o,--output", options->file, "FILE.png; with --animate FILE.gif or FILE.mp4")->required();
  command
      ->add_option("--colour", options->colour,
                   "of the balls: speed [m/s]; height [m]; drums: slot (the way out they took), axial (place along the "
                   "axis [m]) [default: speed; scenes: height]")
      ->check(CLI::IsMember({"speed", "height", "slot", "axial"}));
  command->add_option("--view", options->view, "all, or the drum's outlet end [default: all; --animate: outlet]")
      ->check(CLI::IsMember({"all", "outlet"}));
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels [default: 1400x900; --animate: 640x480]");
  command->add_flag("--animate", options->animate,
                    "film: the simulation goes on from the state, with the belt and its bed as they are");
  command->add_option("--frames", options->moment.frames, "--animate: pictures")
      ->capture_default_str()
      ->check(CLI::Range(2, 5000));
  command->footer(
      "Examples:\n"
      "  drumsweep picture out/warm_state.h5 -o drum.png                    as it is stored\n"
      "  drumsweep picture out -o best.png --colour slot --lead 3           the best design, 3 s later, with its bed\n"
      "  drumsweep picture out --at 3,0.035 -o film.gif --animate           a turn of the drum, the outlet end\n"
      "  drumsweep picture out/warm_state.h5 -o film.mp4 --animate --frames 120 --seconds 4 --size 1280x720\n"
      "  drumsweep picture pile/pile.h5 -o pile.png                         a scene\n"
      "The projection is parallel: the scale bar, in metres, holds for all that lies across the line of sight. In a "
      "run, "
      "balls\n"
      "end where they meet the belt; here they lie on it and ride away. Needs POV-Ray (apt-get install povray), "
      "--animate\n"
      "FFmpeg as well (apt-get install ffmpeg).");
  command->callback([options, &exit_code] { exit_code = picture(*options); });
}

}  // namespace drumsweep
