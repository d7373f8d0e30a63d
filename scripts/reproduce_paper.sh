#!/bin/bash
# Runs the experiments of the paper's section 4 and draws its figures.
#   scripts/reproduce_paper.sh DATA_DIR OUT_DIR
# DATA_DIR holds Middlebury sets as their sites ship them (Teddy of 2003, MiddEval3 at any size); of the
# paper's scenes Djembe, Hoops, Piano and Teddy those are used that are there. OUT_DIR gets fig4.png,
# fig5.png, table1.txt, tables.md, paper.json and the raw measurements. Leave the machine alone meanwhile.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
[ $# -eq 2 ] || { echo "usage: reproduce_paper.sh DATA_DIR OUT_DIR" >&2; exit 2; }
[ -d "$1" ] || fail "$1 is no directory; it should hold Middlebury stereo pairs"
data="$(cd "$1" && pwd)"
mkdir -p "$2"
output="$(cd "$2" && pwd)"
rounds="${AGS_ROUNDS:-25}"

"$repository/scripts/setup.sh"
say "Building"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release >"$output/build.log" 2>&1 ||
  { cat "$output/build.log"; fail "cmake failed"; }
cmake --build "$build_dir" -j"$(nproc)" --target evaluate process_bag simulate_flight \
  adaptive_grid_stereo_generate_messages >>"$output/build.log" 2>&1 ||
  { tail -n 30 "$output/build.log"; fail "the build failed; its log is $output/build.log"; }
tools="$build_dir/devel/lib/adaptive_grid_stereo"
source_build

# The paper's aircraft: 20 m/s, 10 and 8 revolutions per second. One thread, as a measure of work.
aircraft=(--max-speed 20 --max-yaw-rate 62.83185 --max-pitch-rate 50.26548)
scenes='(Djembe|Hoops|Piano|Teddy|Motorcycle|teddy)/im[02]'

say "Figure 4: time against forward speed, $rounds rounds"
"$tools/evaluate" "$data" --scenes "$scenes" --methods 'uniform 16|forward' --no-peers \
  --speeds 0 1 2 3 4 5 6 7 8 10 12 14 16 18 20 "${aircraft[@]}" --threads 1 --repeat "$rounds" \
  --output "$output/speed" --force >"$output/speed.txt"

say "Table 1: forward, yaw and pitch state on Teddy at 10 m/s, $rounds rounds"
"$tools/evaluate" "$data" --scenes '(Teddy|teddy)/im[02]' \
  --methods 'uniform 16|forward|yaw|pitch' --no-peers --speeds 10 --turn-speed 10 "${aircraft[@]}" \
  --threads 1 --repeat "$rounds" --output "$output/states" --force >"$output/states.txt"

say "Figure 5: a simulated flight at 256x144 in the yaw state"
"$tools/simulate_flight" "$output/flight.bag" --states forward,yaw_left,yaw_right --duration 16 --force
"$tools/process_bag" "$output/flight.bag" --output "$output/adaptive.bag" --force
"$tools/process_bag" "$output/flight.bag" --output "$output/uniform.bag" --force \
  --paths-near 16 --paths-far 16 >/dev/null

say "Drawing"
python3 "$repository/scripts/plot_paper.py" "$output"
say "Written: $output/fig4.png, fig5.png, table1.txt, paper.json"
