#!/usr/bin/env bash
# Configures and builds a preset; prints the whole log only when something fails.
set -euo pipefail
preset=$1
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p "build/$preset"
log=build/$preset/configure.log
echo "windhover: building (preset $preset) …"
if ! cmake --preset "$preset" > "$log" 2>&1; then
  cat "$log" >&2
  exit 4
fi
cmake --build --preset "$preset" -j "$(nproc)"
