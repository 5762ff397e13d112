#!/usr/bin/env bash
# Runs what schedules/README.md reports, and writes its tables to schedules/results/*.csv.
# usage: schedules/reproduce.sh PART [OUTPUT_FOLDER]     (default: papers; run again to go on after an interruption)
#   samples      S1's four sample points under every reading of the paper that is on offer      0.6 core-hours
#   line         which opening angle would give the outflow that S1 describes                   0.1
#   holdup       what sets the number of balls in the lab drum                                   0.6
#   convergence  f of S1's optimum over time step and iterations                                 7
#   adaptive     S1's surface and optimum with a thirtieth of its simulations                    1.0
#   pellets      S0's validation systems                                                         0.1
#   slice        how fast smooth and nonsmooth steps carry balls along the drum                  1.2
# As many runs side by side as there are cores.   PART --list: only says what would run.
set -euo pipefail
part=${1:?which part? see the top of this file}
out=${2:-papers}
[ "$out" = --list ] || out=$(realpath -m -- "$out")
program=${DRUMSWEEP:+$(realpath -- "$DRUMSWEEP")}
source "$(dirname "${BASH_SOURCE[0]}")/../cluster/setup.sh" # goes to the project's folder, and lets root use MPI
program=${program:-$PWD/build/release/drumsweep}

# steps MILLISECONDS ITERATIONS: the keys
steps() {
  case $1 in
    10) echo -n solver.outer_step_s=0.010 solver.sub_steps=1 ;;
    5) echo -n solver.outer_step_s=0.010 solver.sub_steps=2 ;;
    2) echo -n solver.outer_step_s=0.008 solver.sub_steps=4 ;;
    1) echo -n solver.outer_step_s=0.008 solver.sub_steps=8 ;;
  esac
  echo " solver.iterations=$2"
}

# One line a run: folder, study, keys.
runs() {
  local fine step iterations
  fine=$(steps 2 10)
  case $part in
    samples)
      local unit
      for unit in deg rad; do
        local study=lab2013_${unit}_samples.toml
        echo "$unit $study"
        echo "${unit}_fine $study $fine"
        echo "${unit}_coating_3mm $study effects.outlet_coating_m=0.003"
        echo "${unit}_coating_6mm $study effects.outlet_coating_m=0.006"
        echo "${unit}_other_sense $study outlet.bisector_sense=against_rotation"
      done
      ;;
    line) echo "rad lab2013_rad_line.toml" ;;
    holdup)
      local study=lab2013_deg_optimum.toml
      echo "as_printed $study"
      echo "width_two_sigma $study drum.texture.width_is=two_sigma"
      echo "texture_none $study drum.texture.density_1_m2=0"
      echo "texture_half $study effects.texture_height_scale=0.5"
      echo "texture_double $study effects.texture_height_scale=2"
      echo "texture_triple $study effects.texture_height_scale=3"
      echo "rolling_0.05 $study effects.rolling_friction=0.05"
      echo "rolling_0.1 $study effects.rolling_friction=0.1"
      echo "rolling_0.3 $study effects.rolling_friction=0.3"
      echo "rolling_0.3_texture_double $study effects.rolling_friction=0.3 effects.texture_height_scale=2"
      echo "iterations_100 $study solver.iterations=100"
      echo "cold_start $study solver.warm_start=false"
      echo "fine $study $fine"
      echo "narrow_outlet $study warmup.opening_angle_deg=0 warmup.base_width_m=0.010"
      echo "wide_outlet $study warmup.opening_angle_deg=0.6 warmup.base_width_m=0.200"
      ;;
    convergence)
      # The cheap ones first.
      local study=lab2013_deg_optimum.toml
      echo "smooth $study step.method=smooth step.contact_speed_m_s=0.3"
      while read -r step iterations; do
        echo "${step}ms_x_$iterations $study $(steps "$step" "$iterations")"
      done <<<"10 10
10 25
5 10
10 50
2 10
5 25
2 25
10 100
1 10
5 50
2 50
1 25
5 100
2 100
1 50
10 400
1 100
5 400
2 400
1 400"
      ;;
    adaptive) echo "deg lab2013_deg_adaptive.toml" ;;
    pellets)
      local drum="scenes/drum_pellets.toml scene.settle_turns=0.25 scene.record_turns=0.5"
      echo "drum_rolling_0.30 $drum"
      echo "drum_no_rolling $drum effects.rolling_friction=0"
      echo "drum_1_rad_s $drum scene.angular_velocity_rad_s=1"
      echo "pile_rolling_0.30 scenes/pile.toml"
      echo "pile_no_rolling scenes/pile.toml effects.rolling_friction=0"
      echo "bed_rolling_0.30 scenes/conveyor.toml"
      echo "bed_no_rolling scenes/conveyor.toml effects.rolling_friction=0"
      ;;
    slice)
      # The lab drum's load in 0.2 m, periodic and inclined: holdup is feed over axial velocity.
      local slice="scenes/drum.toml scene.inclination_deg=7.5 scene.fill=0.0275 scene.length_m=0.2 scene.settle_turns=3 scene.record_turns=8"
      local smooth="$slice step.method=smooth step.contact_speed_m_s=0.3"
      while read -r step iterations; do
        echo "${step}ms_x_$iterations $slice $(steps "$step" "$iterations")"
      done <<<"10 25
2 10
2 25
1 50"
      echo "smooth_25 $smooth"
      echo "smooth_50 $smooth step.steps_per_contact=50"
      echo "smooth_100 $smooth step.steps_per_contact=100"
      echo "smooth_200 $smooth step.steps_per_contact=200"
      ;;
    *)
      echo "reproduce.sh: $part: no such part; see the top of the file" >&2
      return 2
      ;;
  esac
}

# Of one line; a run that ends with some designs failed (exit code 4) has said which, and is no reason to stop.
run_one() {
  local out=$1 name=$2 study=$3 key keys=()
  shift 3
  for key in "$@"; do keys+=(--set "$key"); done
  local command=(run) launch=()
  if [[ $study == scenes/* ]]; then
    command=(simulate --threads 1)
    ! compgen -G "$out/$name/*_observables.csv" >/dev/null || return 0 # delete the folder to have it again
  elif [ "$ranks" -gt 1 ]; then
    launch=(mpirun --oversubscribe -n "$ranks")
  fi
  "${launch[@]}" "$program" "${command[@]}" "schedules/$study" "${keys[@]}" -o "$out/$name" >"$out/$name.log" 2>&1 || [ $? -eq 4 ] || {
    echo "reproduce.sh: $name: see $out/$name.log" >&2
    return 1
  }
  echo "$name: done"
}
export -f run_one
export program

list=$(runs)
if [ "$out" = --list ]; then
  echo "$list"
  exit
fi
mkdir -p "$out/$part" schedules/results
ranks=$(($(nproc) / $(wc -l <<<"$list"))) # of each run: fewer runs than cores take more of them
ranks=$((ranks > 1 ? ranks : 1))
export ranks
failed=0
xargs -P "$(nproc)" -I{} bash -c 'run_one "$0" {}' "$out/$part" <<<"$list" || failed=1

# The table has what there is.
table=$PWD/schedules/results/$part.csv
cd "$out/$part"
names=()
for name in $(cut -d' ' -f1 <<<"$list"); do
  if [ -e "$name/study.toml" ] || compgen -G "$name/*_observables.csv" >/dev/null; then names+=("$name"); fi
done
if [[ $list == *scenes/* ]]; then
  head -qn1 "${names[0]}"/*_observables.csv | sed 's/^/run,/' >"$table"
  for name in "${names[@]}"; do sed "1d; s/^/$name,/" "$name"/*_observables.csv >>"$table"; done
else
  "$program" compare "${names[@]}" -o "$table"
fi

# The four points of a unit as in S1's Figure 9, side by side.
if [ "$part" = samples ] && command -v gnuplot >/dev/null && command -v ffmpeg >/dev/null; then
  for unit in deg rad; do
    pictures=()
    for at in 0.20,0.048 0.17,0.051 0.0,0.010 0.6,0.200; do
      "$program" sample $unit --at $at -o "figure/${unit}_$at" >/dev/null
      pictures+=(-i "figure/${unit}_$at/sample.png")
    done
    ffmpeg -loglevel error -y "${pictures[@]}" -filter_complex hstack=inputs=4,scale=1500:-1 \
      "$(dirname "$table")/samples_$unit.png"
  done
fi
if [ "$part" = adaptive ]; then
  "$program" rescore deg --belt-speed 0.125,0.5 -o belt_speed.csv
  cp belt_speed_summary.csv "$(dirname "$table")/belt_speed.csv"
  if command -v gnuplot >/dev/null; then "$program" contour deg -o "$(dirname "$table")/surface_deg.png"; fi
fi
exit $failed
