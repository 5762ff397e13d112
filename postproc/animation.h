/// Pictures one after the other as a film: POV-Ray draws, FFmpeg joins.
#pragma once

#include <optional>
#include <string>

#include "postproc/child_process.h"
#include "postproc/picture.h"

namespace drumsweep {

class Animation {
 public:
  /// @param path  ending .gif or .mp4
  /// @throws InputError for another ending, std::runtime_error saying what to install
  Animation(std::string path, const PictureOptions& options);

  /// Camera and colours are those of the first picture.
  void add(const Still& still, const std::string& caption);
  /// The file, whole or not at all. @throws WriteError, std::runtime_error
  void write(double pictures_per_second);

 private:
  std::string path_;
  PictureOptions options_;
  std::optional<PictureFrame> frame_;
  ScratchFolder scratch_;
  int num_pictures_ = 0;
};

}  // namespace drumsweep
