#!/bin/bash
# Installs what is missing, builds, simulates a flight, plays it through the nodelet, and draws what
# happened. Results are written to demo_output/ in the repository.
#   scripts/demo.sh [--rviz]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

rviz=false
for option in "$@"; do
  case "$option" in
    --rviz) rviz=true ;;
    *) fail "there is no option $option; usage: demo.sh [--rviz]" ;;
  esac
done

output="$repository/demo_output"
flight="$output/flight.bag"
processed="$output/processed.bag"
tools="$build_dir/devel/lib/adaptive_grid_stereo"

if $rviz; then "$repository/scripts/setup.sh" --rviz; else "$repository/scripts/setup.sh"; fi

say "Building"
configure_log="$(mktemp)"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release >"$configure_log" 2>&1 ||
  { cat "$configure_log"; fail "cmake failed"; }
rm -f "$configure_log"
cmake --build "$build_dir" -j"$(nproc)" --target adaptive_grid_stereo_nodelet simulate_flight \
  adaptive_grid_stereo_generate_messages
source_build

mkdir -p "$output"
if [ -f "$flight" ]; then
  say "Flight: $flight is there already"
else
  say "Simulating a flight of 30 s (about half a minute)"
  "$tools/simulate_flight" "$flight"
fi

say "Playing the flight through the nodelet, at real time"
rm -f "$processed" "$processed.active"
# A master of its own, so that one that runs already is left in peace.
port="$(python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')"
export ROS_MASTER_URI="http://localhost:$port"
roslaunch -p "$port" "$repository/scripts/demo.launch" bag:="$flight" output:="$processed" \
  rviz:="$rviz" >"$output/roslaunch.log" 2>&1 || true
if [ ! -s "$processed" ]; then
  tail -n 40 "$output/roslaunch.log" >&2
  fail "the nodelet's output was not recorded; the whole log is in $output/roslaunch.log"
fi

say "Drawing"
python3 "$repository/scripts/plot_flight" "$processed" --flight "$flight" --output "$output"
