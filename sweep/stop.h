/// Orderly stop on SIGINT, SIGTERM, SIGHUP and SIGUSR2 (which mpirun and Slurm pass on): the handler only notes the
/// signal, whoever runs a loop asks.
#pragma once

#include <string>

namespace drumsweep {

/// From now on these signals ask for a stop; the same one again ends the process at once (nothing durable is lost).
/// Signals that are ignored (nohup) stay ignored. SIGPIPE is ignored: a closed terminal must not end a run.
void install_stop_signals();

/// Name of the signal that asked for a stop, empty while none did.
std::string stop_signal();
bool stop_requested();

}  // namespace drumsweep
