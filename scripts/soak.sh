#!/bin/bash
# Runs the nodelet for a long time at the camera's full rate while all sorts of faults happen at random, and says
# how it went. Exit code 1: the process died, did not serve again after a fault, or its memory grew.
#   scripts/soak.sh [MINUTES] [--seed N] [--size WxH] [--rate HZ]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

usage="usage: soak.sh [MINUTES] [--seed N] [--size WxH] [--rate HZ]"
minutes=10
seed=1
size=640x360
rate=20
while [ $# -gt 0 ]; do
  case "$1" in
    --seed) seed="${2:?$usage}"; shift 2 ;;
    --size) size="${2:?$usage}"; shift 2 ;;
    --rate) rate="${2:?$usage}"; shift 2 ;;
    [0-9]*) minutes="$1"; shift ;;
    *) fail "there is no option $1; $usage" ;;
  esac
done

output="${AGS_SOAK_DIR:-$build_dir/soak}"
flight="$output/flight_$size.bag"
mkdir -p "$output"
say "Building"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release >"$output/build.log" 2>&1 &&
  cmake --build "$build_dir" -j"${AGS_JOBS:-$(nproc)}" --target adaptive_grid_stereo_nodelet simulate_flight \
    adaptive_grid_stereo_generate_messages >>"$output/build.log" 2>&1 ||
  { tail -n 20 "$output/build.log" >&2; fail "the build failed"; }
source_build
if [ ! -f "$flight" ]; then
  say "Simulating the flight whose images are used"
  "$build_dir/devel/lib/adaptive_grid_stereo/simulate_flight" "$flight" --size "$size" --duration 20 --rate 2 --no-truth
fi

say "Flying for $minutes min"
port="$(python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')"
export ROS_MASTER_URI="http://localhost:$port"
period="$(python3 -c "print(1.0 / $rate)")"
roslaunch -p "$port" "$repository/scripts/soak.launch" period:="$period" >"$output/roslaunch.log" 2>&1 &
launcher=$!
trap 'kill -INT $launcher 2>/dev/null; wait $launcher 2>/dev/null || true' EXIT
python3 -B "$repository/scripts/soak.py" "$flight" --minutes "$minutes" --seed "$seed" --rate "$rate"
