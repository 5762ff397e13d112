#include "sweep/stop.h"

#include <csignal>

namespace drumsweep {
namespace {

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t received = 0, checkpoints = 0;

extern "C" void note_signal(int number) { received = number; }
extern "C" void note_checkpoint(int) { checkpoints = checkpoints + 1; }

}  // namespace

void install_stop_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGUSR2}) {
    struct sigaction before {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = note_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    ::sigaction(number, &action, nullptr);
  }
  struct sigaction action {};
  action.sa_handler = note_checkpoint;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGUSR1, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

int num_checkpoint_requests() { return checkpoints; }
void request_checkpoint() { checkpoints = checkpoints + 1; }

bool stop_requested() { return received != 0; }

std::string stop_signal() {
  switch (received) {
    case 0:
      return "";
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "SIGUSR2";
  }
}

}  // namespace drumsweep
