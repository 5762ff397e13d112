/// Orderly stop on SIGINT, SIGTERM, SIGHUP and SIGUSR2, a checkpoint on SIGUSR1 (mpirun and Slurm pass them on): the
/// handler only notes the signal, whoever runs a loop asks.
#pragma once

#include <string>

namespace drumsweep {

/// From now on these signals ask for a stop; the same one again ends the process at once (nothing durable is lost).
/// Signals that are ignored (nohup) stay ignored. SIGPIPE is ignored: a closed terminal must not end a run.
void install_stop_signals();

/// How often a checkpoint was asked for so far: whoever has seen fewer makes one and goes on.
int num_checkpoint_requests();
/// The same as a SIGUSR1.
void request_checkpoint();

/// Name of the signal that asked for a stop, empty while none did.
std::string stop_signal();
bool stop_requested();

}  // namespace drumsweep
