#!/usr/bin/env bash
# Installs the Debian packages that windhover needs and that are missing; says which.
# docs/dependencies.md gives the reason of each. Arguments are further packages.
set -euo pipefail
packages=(
  cmake g++ git ninja-build pkg-config
  libgtest-dev libgmock-dev libbenchmark-dev
  liblcm-dev liblcm-bin
  libeigen3-dev libopencv-dev libosmesa6-dev libassimp-dev
  libyaml-cpp-dev libcli11-dev libfmt-dev libspdlog-dev nlohmann-json3-dev libxxhash-dev libre2-dev libssl-dev
  libdnnl-dev libonnx-dev libprotobuf-dev libtorch-dev
  iproute2 "$@"
)
missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query -W -f='${Status}' "$package" 2> /dev/null || true)
  [[ $state == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo > /dev/null; then
    echo "windhover: error: these packages are missing: ${missing[*]}" >&2
    echo "  as root: apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 4
  fi
  as_root=(sudo)
fi
echo "windhover: installing with apt: ${missing[*]}"
log=$(mktemp)
if ! { "${as_root[@]}" apt-get update -qq &&
       "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
         apt-get install -y -qq --no-install-recommends "${missing[@]}"; } > "$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "windhover: error: apt could not install: ${missing[*]}" >&2
  exit 4
fi
rm -f "$log"
