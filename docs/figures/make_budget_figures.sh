#!/bin/sh
# Draws the figures of docs/physics.md, section "Error budget". From the root of the repository:
#   docs/figures/make_budget_figures.sh build/release/bin/windhover
set -e
out=$(mktemp -d)
draw() {
  program=$1 figure=$2
  shift 2
  "$program" budget scenarios/follow_the_leader.yaml --flights 400 --out "$out" "$@" >/dev/null
  mv "$out"/*.svg "$(dirname "$0")/$figure.svg"
}
distances="--distances 5 10 20 40"
draw "$1" budget_calibrated --set observe=geometric
draw "$1" error_by_vibration $distances --sweep vibration.level=0,1,2,4,6,8
draw "$1" error_by_focal_length $distances --set observe=geometric --sweep rig.focal_mm=6,8,12,16,25
draw "$1" error_by_bar_frequency $distances --set vibration.source=rotors \
  --sweep flex.frequency_hz=50,60,70,80,85,90,95,98,100,102,105,110,115,120,130,140,160,180,200,220
rm -r "$out"
