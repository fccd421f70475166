#!/bin/sh
# Flies three scenarios, keeps what each leaves in RESULTS/NAME, and holds it against BASELINE/NAME.json,
# the score.json of main, where that is there. Exit code: 0, or the worst of all.
#   regression.sh WINDHOVER SCENARIOS RESULTS BASELINE
set -u
windhover=$1 scenarios=$2 results=$3 baseline=$4
worst=0
note() { if [ "$1" -gt "$worst" ]; then worst=$1; fi; }

for name in ideal_geometric crossing_pair head_on_swarm; do
  "$windhover" run "$scenarios/$name.yaml" --out "$results/$name"
  note $?
  if [ -f "$baseline/$name.json" ]; then
    "$windhover" compare --baseline "$baseline/$name.json" "$results/$name" \
      --max-worse methods.baseline.abs_rel_all=0.01 --max-worse swarm.collisions=0 \
      --max-worse swarm.min_separation_m=0.2
    note $?
  else
    echo "no stored result of main to compare $name with"
  fi
done
exit "$worst"
