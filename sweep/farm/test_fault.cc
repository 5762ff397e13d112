#include "sweep/farm/test_fault.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "core/config/schema.h"

namespace drumsweep {

TestFault::TestFault(std::size_t index) {
  const char* text = std::getenv("DRUMSWEEP_TEST_FAULT");
  if (text == nullptr) return;
  std::istringstream list(text);
  for (std::string item; std::getline(list, item, ',');) {
    const std::size_t colon = item.find(':');
    const std::string what = item.substr(0, colon);
    Kind kind = Kind::none;
    if (what == "segv") kind = Kind::segv;
    if (what == "abort") kind = Kind::abort;
    if (what == "kill") kind = Kind::kill;
    if (what == "hang") kind = Kind::hang;
    if (what == "nan") kind = Kind::nan;
    if (what == "throw") kind = Kind::exception;
    if (kind == Kind::none || colon == std::string::npos)
      throw InputError("DRUMSWEEP_TEST_FAULT = " + item + ": accepted is segv|abort|kill|hang|nan|throw:INDEX");
    if (std::strtoull(item.c_str() + colon + 1, nullptr, 10) == index) kind_ = kind;
  }
}

void TestFault::between_steps(const Progress& at, DesignProgress& progress) {
  if (kind_ == Kind::none || at.turns < 0.5 * at.turns_planned) return;
  switch (kind_) {
    case Kind::segv:
      ::raise(SIGSEGV);
      break;
    case Kind::abort:
      std::abort();
    case Kind::kill:
      ::raise(SIGKILL);
      break;
    case Kind::hang:
      for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    case Kind::nan:
      if (progress.landings.empty()) return;
      progress.landings.back().y = std::numeric_limits<double>::quiet_NaN();
      kind_ = Kind::none;
      break;
    default:
      throw std::runtime_error("exception asked for by DRUMSWEEP_TEST_FAULT");
  }
}

}  // namespace drumsweep
