#!/usr/bin/env bash
# Sets up everything, builds, and runs the main job on a small real case: warm drum, sweep over MPI, tables, figure, report.
# usage: cluster/quickstart.sh [OUTPUT_FOLDER]     (default: quick_result; run again to go on after an interruption)
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
out=${1:-quick_result}

install_packages cluster/packages.txt
echo "building"
build release drumsweep -DDRUMSWEEP_BUILD_TESTS=OFF
program=build/release/drumsweep

"$program" check schedules/quick.toml
mpirun -n "$(nproc)" --oversubscribe "$program" run schedules/quick.toml -o "$out"
"$program" contour "$out" -o "$out/contour.csv"
"$program" contour "$out" -o "$out/contour_matrix.csv" --matrix
"$program" contour "$out" -o "$out/contour.png"
"$program" report "$out" -o "$out/report.html"
echo "Done. Open $out/report.html; the table is $out/results.csv, the figure $out/contour.png with its data in $out/contour.csv"
