# Sourced by quickstart.sh and test.sh: installs the Debian packages that are missing, then configures and builds.
# Needs nothing but a Debian 12 machine; without root or sudo it prints the one line that an administrator has to run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# install_packages LIST...: files with one package a line
install_packages() {
  local missing=() package
  for package in $(cat "$@"); do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "Packages are missing and this user is not root. Ask an administrator to run:" >&2
      echo "  apt-get install -y ${missing[*]}" >&2
      exit 2
    fi
    root=(sudo)
  fi
  echo "installing ${missing[*]}"
  "${root[@]}" apt-get update -qq
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build PRESET TARGET [cmake options]: configures and builds into build/PRESET
build() {
  local preset=$1 target=$2
  shift 2
  cmake --preset "$preset" -DDRUMSWEEP_JOIN_SOURCES=ON "$@" >/dev/null
  cmake --build --preset "$preset" --target "$target" -- --quiet
}

# Open MPI refuses root unless told twice; a container or a test machine often is root.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
