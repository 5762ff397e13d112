/// Measured tables that ship with the program: postproc/verify/anchors/*.csv, put into a source file by the build.
#pragma once

namespace drumsweep {

struct Anchor {
  const char* name;  ///< file name without ".csv"
  const char* text;
};
extern const Anchor embedded_anchors[];
extern const int num_embedded_anchors;

}  // namespace drumsweep
