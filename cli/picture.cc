/// drumsweep picture
#include "postproc/picture.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/commands.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "core/io/snapshot.h"

namespace drumsweep {
namespace {

struct Options {
  std::string state, file;
  PictureOptions picture;
};

void picture(const Options& options) {
  if (!options.file.ends_with(".png")) throw InputError(options.file + ": unknown ending, accepted: .png");
  const StoredDrum stored = unpack_drum(read_whole_file(options.state), options.state);
  const DrumModel model(stored.study, warmup_outlet(stored.study));
  write_picture(model, stored.warm.state, options.picture, options.file);
  fmt::print("{}\n", options.file);
}

}  // namespace

void add_picture(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("picture", "Render a stored drum: balls and walls, cut open on the near side.");
  command->add_option("STATE", options->state, "warm_state.h5 of a run")->required();
  command->add_option("-o,--output", options->file, "FILE.png")->required();
  command
      ->add_option("--colour", options->picture.colour,
                   "speed: 0 to 1.5 times the wall's; axial: place along the axis; slot: way out")
      ->check(CLI::IsMember({"speed", "axial", "slot"}))
      ->capture_default_str();
  command->add_option("--width", options->picture.width, "pixels")
      ->check(CLI::Range(100, 10000))
      ->capture_default_str();
  command->add_option("--height", options->picture.height, "pixels")
      ->check(CLI::Range(100, 10000))
      ->capture_default_str();
  command->footer("Example:\n  drumsweep picture out/warm_state.h5 -o drum.png\nNeeds POV-Ray.");
  command->callback([options] { picture(*options); });
}

}  // namespace drumsweep
