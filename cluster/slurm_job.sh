#!/bin/bash@shell_options@
# Runs the study "@title@" until it is finished, over as many time limits and lost nodes as that takes.
# Printed by `drumsweep slurm`; submit it with `sbatch`. Submitted again, at any time, it goes on where the study stands.
#
#SBATCH --job-name=@job_name@
#SBATCH --nodes=@nodes@
@tasks@
#SBATCH --time=@time@
@site_options@# The folder of this file must exist. A job that starts again appends to it.
#SBATCH --output=@log@
#SBATCH --open-mode=append
# This many seconds before the time limit (at times a minute earlier) Slurm signals this shell, and only this shell (B:).
#SBATCH --signal=B:USR2@@signal_before_s@
# Slurm itself starts the job again when the node of this shell is lost.
#SBATCH --requeue

@modules@program=@program@
study=@study@
out=@out@
max_requeues=@max_requeues@
restarts=${SLURM_RESTART_COUNT:-0}
ranks_per_node=@ranks_per_node@
# A rank stays in one NUMA domain: near its memory, yet while the drum is being filled rank 0 computes on all cores there.
launch=(@launcher@)

say() { echo "$(date -u '+%Y-%m-%d %H:%M:%S') UTC, job $SLURM_JOB_ID, start $((restarts + 1)): $*"; }

# What is stored decides. The launcher's exit code may be that of a rank which died after the last design was stored.
finished() { "$program" status "$out" --json 2>/dev/null | grep -Eq '"finished": ?true'; }

say "on $SLURM_JOB_NODELIST"

# Once: does the launcher work, do the ranks see each other and the output folder? If not, starting again would not help.
if [ "$restarts" -eq 0 ] && ! "${launch[@]}" "$program" doctor -o "$out" --threads @threads@; then
  say "not fit to run here, see above"
  exit 2
fi

# USR2 asks drumsweep to stop within a time step. A shell that gets a signal leaves `wait`, so it waits again.
job='' signalled='' cancelled=''
trap 'signalled=1; say "the time limit is near, stopping"; [ -z "$job" ] || kill -USR2 "$job" 2>/dev/null' USR2
trap 'signalled=1; cancelled=1; say "Slurm ends the job"' TERM
"${launch[@]}" "$program" run "$study"@changes@ -o "$out" --threads @threads@ &
job=$!
wait "$job"
code=$?
while [ -n "$signalled" ]; do
  signalled=''
  wait "$job"
  code=$?
done

case $code in
  2 | 5 | 6)
    say "exit code $code: starting again would not help, see above"
    exit "$code"
    ;;
esac

if finished; then
  # 0: done, 4: done, some designs have failed. After anything else the table may lack its last rows, a matter of seconds.
  if [ "$code" -ne 0 ] && [ "$code" -ne 4 ]; then
    "$program" run "$study"@changes@ -o "$out"
    code=$?
  fi
  say "finished, exit code $code"
  exit "$code"
fi
if [ -n "$cancelled" ]; then
  say "not finished; submit this script again to go on"
  exit 3
fi
if [ "$restarts" -ge "$max_requeues" ]; then
  say "not finished after $max_requeues requeues; submit this script again to go on"
  exit 3
fi
# Time limit or lost node: back into the queue under the same job id. This ends the shell.
say "exit code $code, not finished: back into the queue"
scontrol requeue "$SLURM_JOB_ID" || say "refused by Slurm; submit this script again to go on"
exit 3
