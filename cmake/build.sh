#!/usr/bin/env bash
# Configures and builds a preset, all of it or the given targets; prints the log of the
# configuration only when it fails.
#   build.sh PRESET [TARGET...]
set -euo pipefail
preset=$1
shift
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p "build/$preset"
log=build/$preset/configure.log
echo "windhover: building (preset $preset) …"
if ! cmake --preset "$preset" > "$log" 2>&1; then
  cat "$log" >&2
  exit 4
fi
targets=()
[[ $# -eq 0 ]] || targets=(--target "$@")
cmake --build --preset "$preset" -j "$(nproc)" "${targets[@]}"
