/// One line of `drumsweep doctor`.
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

struct Finding {
  enum class Level {
    ok,
    warning,  ///< works, but slower or less safely than it could
    problem   ///< a sweep would fail
  };
  Level level = Level::ok;
  std::string subject;  ///< a word or two: "folder", "binding" ...
  std::string text;     ///< what was found, with units
  std::string advice;   ///< what to do about it; empty when all is well
};

}  // namespace drumsweep
