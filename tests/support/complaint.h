/// What wrong input is answered with.
#pragma once

#include <functional>
#include <string>

#include "core/config/schema.h"

namespace drumsweep {

/// The message of the InputError that the work ends with; empty where it accepts its input.
inline std::string complaint(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace drumsweep
