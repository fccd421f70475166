#!/usr/bin/env bash
# Times windhover, OGRE and VTK on the same poses, three times in turn, and prints the least:
#   tests/benchmark/peers/compare.sh build/release/bin [osmesa|native]
# Needs Xvfb and programs built with -DWINDHOVER_PEERS=ON.
set -euo pipefail
bin=$1
rasteriser=${2:-osmesa}
work=$(mktemp -d)
Xvfb -displayfd 4 -screen 0 64x64x24 4> "$work/display" > /dev/null 2>&1 &
server=$!
trap 'kill $server; rm -rf "$work"' EXIT
"$bin/peer_inputs" "$work" > /dev/null
until [[ -s $work/display ]]; do sleep 0.1; done
export DISPLAY=":$(< "$work/display")" LIBGL_ALWAYS_SOFTWARE=1

for turn in 1 2 3; do
  "$bin/windhover" bench render --rounds 3 --rasteriser "$rasteriser" |
    awk '/^full  /{print "windhover", $2, $3}'
  "$bin/ogre_peer" "$work" --rounds 3
  "$bin/vtk_peer" "$work" --rounds 2
done | awk '
  !($1 in cpu) || $2 < cpu[$1] {cpu[$1] = $2}
  !($1 in wall) || $3 < wall[$1] {wall[$1] = $3}
  END {
    printf "%-12s%12s%12s%16s\n", "", "CPU ms/pair", "wall ms", "CPU/windhover";
    split("windhover ogre_peer vtk_peer", names);
    for (i = 1; i <= 3; ++i) {
      n = names[i];
      printf "%-12s%12.1f%12.1f%16.1f\n", n, cpu[n], wall[n], cpu[n] / cpu["windhover"];
    }
  }'
