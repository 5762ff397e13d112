#!/usr/bin/env bash
# Sets up everything for the tests, builds, and runs all of them with ctest.
# usage: cluster/test.sh [PRESET] [ctest options]   (PRESET: release (default), debug, asan)
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
preset=${1:-release}
shift || true

install_packages cluster/packages.txt cluster/packages_test.txt
# Unit tests do not need the program.
case " $* " in *" -L unit "*) target=unit_tests ;; *) target=all ;; esac
build "$preset" "$target" -DDRUMSWEEP_BUILD_TESTS=ON
# One more than there are cores: some tests wait, for Slurm or for a process to die.
ctest --preset "$preset" -j "$(($(nproc) + 1))" "$@"
