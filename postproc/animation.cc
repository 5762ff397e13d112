#include "postproc/animation.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "core/config/schema.h"
#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

constexpr const char* install_ffmpeg = "install FFmpeg: apt-get install ffmpeg";

}  // namespace

Animation::Animation(std::string path, const PictureOptions& options) : path_(std::move(path)), options_(options) {
  if (!path_.ends_with(".gif") && !path_.ends_with(".mp4"))
    throw InputError(path_ + ": unknown ending of an animation, accepted: .gif, .mp4");
  need_povray();
  need_program("ffmpeg", install_ffmpeg);
}

void Animation::add(const Still& still, const std::string& caption) {
  if (!frame_) frame_ = picture_frame(still, options_);
  write_durably((scratch_.path / fmt::format("{:05d}.png", num_pictures_)).string(),
                rendered(still, options_, *frame_, caption));
  ++num_pictures_;
}

void Animation::write(double pictures_per_second) {
  const bool gif = path_.ends_with(".gif");
  std::vector<std::string> command = {
      "ffmpeg", "-v", "error", "-framerate", fmt::format("{:.4f}", pictures_per_second), "-i", "%05d.png"};
  // One palette for all pictures and no dithering: still parts stay still, and the file small.
  const std::vector<std::string> as_gif = {
      "-vf",
      "split[a][b];[a]palettegen=max_colors=64:stats_mode=full[p];[b][p]paletteuse=dither=none:diff_mode=rectangle",
      "-loop", "0", "film.gif"};
  // Players want even sizes and this pixel format.
  const std::vector<std::string> as_mp4 = {"-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                           "-c:v",      "libx264",
                                           "-pix_fmt",  "yuv420p",
                                           "-crf",      "18",
                                           "-movflags", "+faststart",
                                           "film.mp4"};
  command.insert(command.end(), (gif ? as_gif : as_mp4).begin(), (gif ? as_gif : as_mp4).end());
  run_program(scratch_.path, command, install_ffmpeg);
  write_durably(path_, read_whole_file((scratch_.path / (gif ? "film.gif" : "film.mp4")).string()));
}

}  // namespace drumsweep
