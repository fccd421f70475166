#!/usr/bin/env bash
# Makes the pictures of docs/gallery/README.md anew:
#   docs/gallery/make_gallery.sh build/release/bin [playground | … | disturbances | weather]…
# Needs ImageMagick.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=$1
shift
sheets=${*:-playground forest buildings basketball_court disturbances weather}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# An observer at rest at the origin, 20 m up, and a target that hovers ahead of it.
cat > "$work/gallery.yaml" << 'YAML'
description: One instant of the gallery.
duration_s: 1
observe: image
rig: {baseline_m: 0.406, focal_mm: 12, pixel_um: 3.7325, image: [1280, 720]}
render: {rasteriser: native}
aircraft:
  - {id: 0, type: p600, carries_rig: true, position_m: [0, 0, 20]}
  - {id: 1, type: m200_orange, position_m: [15, 0, 20], yaw_deg: 215}
YAML

# shot NAME CROP [key=value …]: the left image, cut to CROP (WxH, about the image's centre).
shot() {
  local name=$1 crop=$2
  shift 2
  local set=()
  for pair in "$@"; do set+=(--set "$pair"); done
  "$bin/windhover" snapshot "$work/gallery.yaml" --time 0.5 --out "$work/shot" "${set[@]}" > /dev/null
  convert "$work/shot/left.png" -gravity center -crop "$crop+0+0" +repage "$work/$name.png"
}

# sheet NAME COLUMNS SIZE: all pictures named NAME_*, in order, as one JPEG.
sheet() {
  montage -label '%t' "$work/$1"_*.png -resize "$3" -tile "$2x" -geometry +4+4 -pointsize 13 \
    -background white -quality 84 "$here/$1.jpg"
}

# pair NAME CROP KEY=OFF KEY=ON [common …]: the same with a disturbance off and on.
pair() {
  local name=$1 crop=$2 off=$3 on=$4
  shift 4
  shot "${name}_0_off" "$crop" "$off" "$@"
  shot "${name}_1_on" "$crop" "$on" "$@"
}

environment() {
  local environment=$1 type distance crop
  for type in m200_orange m200_black p600; do
    for distance in 05 15 30; do
      case $distance in 05) crop=1024x576 ;; 15) crop=512x288 ;; *) crop=320x180 ;; esac
      shot "${environment}_${type}_${distance}m" $crop environment.type=$environment \
        aircraft.1.type=$type "aircraft.1.position_m=[$distance, 0, 20]"
    done
  done
  sheet "$environment" 3 400x
}

near='aircraft.1.position_m=[10, 0, 20]'

disturbances() {
  pair disturbances_1_vibration 640x360 vibration.source=none vibration.source=psd "$near" \
    vibration.level=3 vibration.angular_rate_rms_radps=0.3 exposure.duration_ms=8 exposure.max_samples=32
  pair disturbances_2_defocus 640x360 optics.focus_m=10 optics.focus_m=2 optics.f_number=2.8 "$near"
  pair disturbances_3_vignetting 1280x720 optics.vignetting=false optics.vignetting=true \
    optics.vignetting_r2=10 "$near"
  pair disturbances_4_noise 320x180 sensor.noise=false sensor.noise=true "$near" sensor.full_well_e=500
  pair disturbances_5_rolling_shutter 640x360 exposure.shutter=global exposure.shutter=rolling "$near" \
    vibration.source=psd vibration.level=4 vibration.angular_rate_rms_radps=0.4 exposure.duration_ms=0.3
  pair disturbances_6_jpeg 320x180 sensor.jpeg_quality=0 sensor.jpeg_quality=12 "$near"
  pair disturbances_7_distortion 1280x720 rig.distortion.k1=0 rig.distortion.k1=-1 "$near"
  sheet disturbances 2 480x
}

weather() {
  pair weather_1_overcast 640x360 environment.cloud_cover=0 environment.cloud_cover=1 "$near"
  pair weather_2_dusk 640x360 environment.sun_elevation_deg=45 environment.sun_elevation_deg=3 "$near"
  pair weather_3_haze 640x360 environment.visibility_m=20000 environment.visibility_m=150 \
    'aircraft.1.position_m=[30, 0, 20]'
  sheet weather 2 480x
}

for name in $sheets; do
  case $name in
    disturbances | weather) "$name" ;;
    *) environment "$name" ;;
  esac
done
