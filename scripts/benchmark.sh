#!/bin/bash
# Builds the benchmarks, runs them, and writes table, JSON and plot into benchmark_output/ in the
# repository, or into the folder named.
#   scripts/benchmark.sh [OUT_DIR] [options of matcher_benchmark, e.g. --rounds 5 --sizes 450x375]
# The Teddy pair is taken from $ADAPTIVE_GRID_STEREO_DATA, or ../shared/data beside the repository,
# where it is there. Leave the machine alone meanwhile.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

output="$repository/benchmark_output"
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
  output="$1"
  shift
fi
mkdir -p "$output"
output="$(cd "$output" && pwd)"
data="${ADAPTIVE_GRID_STEREO_DATA:-$repository/../shared/data}"
if [ -d "$data" ]; then
  export ADAPTIVE_GRID_STEREO_DATA="$data"
else
  say "No data in $data: a made-up pair stands in for Teddy"
  unset ADAPTIVE_GRID_STEREO_DATA
fi

"$repository/scripts/setup.sh"
say "Building"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release >"$output/build.log" 2>&1 ||
  { cat "$output/build.log"; fail "cmake failed"; }
targets=(matcher_benchmark)
if grep -q 'add_executable(kernels_benchmark' "$repository"/benchmark/*.cmake 2>/dev/null; then
  targets+=(kernels_benchmark)
fi
cmake --build "$build_dir" -j"$(nproc)" --target "${targets[@]}" >>"$output/build.log" 2>&1 ||
  { tail -n 30 "$output/build.log"; fail "the build failed; its log is $output/build.log"; }
binaries() { find "$build_dir" -type f -perm -u+x -name "$1" | head -n 1; }

if [ "${#targets[@]}" -gt 1 ]; then
  say "Kernels, one by one"
  "$(binaries kernels_benchmark)" --benchmark_out="$output/kernels.json" \
    --benchmark_out_format=json | tee "$output/kernels.txt"
fi

say "The whole matcher and OpenCV's, taking turns"
"$(binaries matcher_benchmark)" --json "$output/matcher.json" --force "$@" | tee "$output/matcher.txt"
python3 "$repository/scripts/plot_benchmark.py" "$output/matcher.json" "$output/matcher.png"
say "Written: $output/matcher.txt, matcher.json, matcher.png"
