/// For the tests of what a sweep survives; not for users.
///
/// DRUMSWEEP_TEST_FAULT=WHAT:INDEX[,WHAT:INDEX...] makes the design with this index in the plan fail, in the middle of
/// its run and every time:
///   segv, abort  the process dies of that signal       kill   of SIGKILL, so that nothing is left to say why
///   hang         the step never ends
///   nan          a landing is not a number            throw  the engine throws an exception
#pragma once

#include <cstddef>

#include "core/scene/drum.h"

namespace drumsweep {

class TestFault {
 public:
  /// Reads the environment. @throws InputError when it cannot be understood
  explicit TestFault(std::size_t index);
  /// To be called between two steps: does it when half of the turns are done.
  void between_steps(const Progress& at, DesignProgress& progress);

 private:
  enum class Kind { none, segv, abort, kill, hang, nan, exception } kind_ = Kind::none;
};

}  // namespace drumsweep
