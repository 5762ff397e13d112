#!/usr/bin/env bash
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd) root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

help() {
  cat <<'END'
The same drum slice in drumsweep and in the granular codes that Debian 12 has: LAMMPS, LIGGGHTS and YADE, one after the other on one core.
usage: tests/bench/peers.sh [--install] [--drumsweep PATH] [--turns T]

  --install         apt-get install lammps liggghts yade first (as root; YADE alone is over 100 packages);
                    without it, peers that are missing are skipped
  --drumsweep PATH  the program to compare with (build/release/drumsweep)
  --turns T         settle T turns, record T turns (1; 2.51 s each)

The slice: 10 000 balls of 10 mm, 2500 kg/m3, E = 0.5 MPa, Poisson 0.25, friction 0.7, restitution 0.1; a smooth rigid drum of 0.75 m,
periodic over 0.1 m, at 2.5 rad/s. t_c is the contact time of a ball and the wall at 1 m/s; manuals advise a step of t_c/25 to t_c/50,
and t_c/10 is near the most that LIGGGHTS accepts (a fifth of Rayleigh's time).

The table: wall and CPU time with start, settling, recording and dumps; wall time over that of drumsweep's smooth step at t_c/25 and over
that of its nonsmooth step with 4 x 5 passes in 10 ms; load: the machine's over the last minute, 1 where nothing else ran. With neighbours
on the same cores even CPU times double or treble, so compare on a quiet machine. The bed surges on the smooth wall: the errors
are its swing, and one turn does not average it out. Observables of all programs by core/scene/slice_field.cc. YADE is too slow for a
turn: 0.05 s from the bed of another peer, for its cost alone. Takes 10 minutes on a quiet machine; progress goes to stderr.
END
}

drumsweep=$root/build/release/drumsweep install=no turns=1
while (($#)); do
  case $1 in
    --install) install=yes ;;
    --drumsweep) drumsweep=${2:?--drumsweep needs a path} && shift ;;
    --turns) turns=${2:?--turns needs a number} && shift ;;
    -h | --help) help && exit ;;
    *) echo "peers.sh: unknown option $1" >&2 && help >&2 && exit 2 ;;
  esac
  shift
done
[[ -x $drumsweep ]] || { echo "peers.sh: no program $drumsweep; build it or give --drumsweep PATH" >&2 && exit 2; }
[[ $install == no ]] || DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends lammps liggghts yade >&2

work=$(mktemp -d) num_balls=10000
trap 'rm -rf "$work"' EXIT
export OMP_NUM_THREADS=1 LC_ALL=C
one_core=()
[[ $("$drumsweep" simulate --help) != *--threads* ]] || one_core=(--threads 1)
say() { echo "peers.sh: $*" >&2; }
calc() { awk "BEGIN { printf \"%.6g\", $1 }"; }

# measure LOG COMMAND...: sets wall and cpu [s].
measure() {
  local log=$1 user system TIMEFORMAT='%R %U %S'
  shift
  { time nice -n 10 "$@" >"$log" 2>&1 </dev/null; } 2>"$work/time" || { say "failed: $*" && tail -20 "$log" >&2 && return 1; }
  read -r wall user system <"$work/time"
  cpu=$(calc "$user + $system")
}

# row PROGRAM SETTING SIMULATED_S [SPEED ERROR ANGLE ERROR]: from wall and cpu.
row() {
  local program=$1 setting=$2 simulated=$3 speed=- angle=-
  (($# < 7)) || { printf -v speed '%.3f +- %.3f' "$4" "$5" && printf -v angle '%.2f +- %.2f' "$6" "$7"; }
  printf '%s|%s|%.4f|%.4f|%s|%s|%s\n' "$program" "$setting" "$(calc "$wall / $simulated")" \
    "$(calc "$cpu / $simulated / $num_balls * 1000")" "$speed" "$angle" "$(cut -d' ' -f1 /proc/loadavg)" | tee -a "$work/rows" >&2
}

# run_drumsweep NAME SETTING < the sections [step] and [solver]
run_drumsweep() {
  say "drumsweep, $2"
  { sed "/^type/a settle_turns = $turns\nrecord_turns = $turns" "$here/peers/drum.toml" && cat; } >"$work/$1.toml"
  measure "$work/$1.log" "$drumsweep" simulate "$work/$1.toml" -o "$work/$1" "${one_core[@]}"
  row drumsweep "$2" "$(calc "2 * $turns * $turn")" $(awk -F, '$1 == "surface_velocity" { v = $4 " " $5 }
    $1 == "charge_angle" { a = $4 " " $5 } END { print v, a }' "$work/$1/drum_observables.csv")
}

# run_peer PROGRAM EXECUTABLE INPUT STEPS_PER_CONTACT, for both descendants of LAMMPS. Frames: 128, as analyse.cc wants them.
run_peer() {
  local dt every record
  say "$1, t_c/$4"
  dt=$(calc "$contact / $4")
  every=$(calc "int($turns * $turn / 128 / $dt + 0.5)") && record=$((128 * every))
  cd "$work" # the programs leave logs where they run
  measure "$work/$2.log" "$2" -in "$here/peers/$3" -var balls "$work/balls.data" -var dt "$dt" -var every "$every" \
    -var settle "$record" -var record "$record" -var dump "$work/$2.dump"
  cd - >/dev/null
  row "$1" "t_c/$4" "$(calc "2 * $record * $dt")" $("$work/analyse" "$work/$2.dump")
}

# For all: the turn; contact time as in core/step/world.cc; the analysis; a loose bed, a fifth of its places empty as in drumsweep.
turn=$(calc "2 * 3.14159265358979 / 2.5")
contact=$(calc "2.943 * (1.25 * 1.30900e-3 / (4 / 3 * 0.5e6 / (1 - 0.25 ^ 2) * sqrt(0.005))) ^ 0.4")
"${CXX:-c++}" -std=c++20 -O2 -I"$root" "$here/peers/analyse.cc" "$root/core/scene/slice_field.cc" -o "$work/analyse"
awk -v n=$num_balls 'BEGIN {
  srand(1); R = 0.375; L = 0.1; d = 0.01; layers = 9
  print "bed\n\n" n " atoms\n2 atom types\n-0.45 0.45 xlo xhi\n-0.45 0.45 ylo yhi\n0 " L " zlo zhi\n\nAtoms\n"
  for (y = -R; i < n; y += 1.07 * d)
    for (x = -R; x < R; x += 1.07 * d)
      for (k = 0; k < layers && i < n && x * x + y * y < (R - 0.6 * d) ^ 2; ++k)
        if (rand() < 0.8)
          printf "%d 1 %g 2500 %.6f %.6f %.6f\n", ++i, d, x + 0.05 * d * (rand() - 0.5), y + 0.05 * d * (rand() - 0.5),
                 (k + 0.5 + 0.05 * (rand() - 0.5)) * L / layers
}' >"$work/balls.data"

for steps in 25 10; do run_drumsweep "smooth$steps" "smooth, t_c/$steps" <<END; done
[step]
method = "smooth"
steps_per_contact = $steps
END
for passes in "4 5" "1 25"; do run_drumsweep "nonsmooth${passes/ /x}" "nonsmooth, 10 ms, ${passes/ / x }" <<END; done
[solver]
outer_step_s = 0.01
sub_steps = ${passes% *}
iterations = ${passes#* }
END
for steps in 25 10; do
  if command -v lmp >/dev/null; then run_peer LAMMPS lmp drum.lammps $steps; else say "no LAMMPS (lmp): skipped"; fi
  if command -v liggghts >/dev/null; then run_peer LIGGGHTS liggghts drum.liggghts $steps; else say "no LIGGGHTS: skipped"; fi
done

# YADE times itself, without its start and the first search for contacts.
dump=$(ls "$work"/*.dump 2>/dev/null | head -1 || true)
if ! command -v yade >/dev/null || [[ -z $dump ]]; then
  say "no YADE, or no other peer whose bed it could start from: skipped"
else
  say "YADE, t_c/25, 0.05 s"
  export PEERS_DUMP=$dump PEERS_DT PEERS_TIME=0.05
  PEERS_DT=$(calc "$contact / 25")
  measure "$work/yade.log" yade -n -x -j1 "$here/peers/drum_yade.py"
  read -r wall cpu simulated < <(awk '$1 == "cost" { print $2, $3, $4 }' "$work/yade.log")
  row YADE t_c/25 "$simulated"
fi

awk -F'|' '
  function line(a, b, c, d, e, f, g, h, i) {
    printf "%-10s %-24s %11s %13s %16s %16s %9s %12s %6s\n", a, b, c, d, e, f, g, h, i
  }
  NR == 1 { line("program", "setting", "wall s / s", "CPU s/1000/s", "surface m/s", "angle deg", "/ smooth", "/ nonsmooth", "load") }
  NR == FNR { if ($2 == "smooth, t_c/25") smooth = $3; if ($2 == "nonsmooth, 10 ms, 4 x 5") nonsmooth = $3; next }
  { line($1, $2, sprintf("%.2f", $3), sprintf("%.3f", $4), $5, $6, sprintf("%.2f", $3 / smooth), sprintf("%.2f", $3 / nonsmooth), $7) }
' "$work/rows" "$work/rows"
