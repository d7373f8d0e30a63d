#!/bin/bash
# Builds the libFuzzer harnesses with clang and the address and undefined-behaviour sanitizers, and runs each of them.
#   scripts/fuzz.sh [SECONDS_PER_HARNESS | --runs N] [--only NAME]...
# Without arguments: 60 s each. Inputs that end a harness are left in <build>/findings/; exit code 1 if there are any.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

usage="usage: fuzz.sh [SECONDS_PER_HARNESS | --runs N] [--only NAME]..."
limit=(-max_total_time=60)
only=()
while [ $# -gt 0 ]; do
  case "$1" in
    --runs) limit=("-runs=${2:?$usage}"); shift 2 ;;
    --only) only+=("${2:?$usage}"); shift 2 ;;
    [0-9]*) limit=("-max_total_time=$1"); shift ;;
    *) fail "there is no option $1; $usage" ;;
  esac
done

command -v clang++ >/dev/null || fail "clang++ is missing: apt-get install clang libclang-rt-14-dev"
build="${AGS_FUZZ_BUILD_DIR:-$repository/build_fuzz}"
log="$build/build.log"
mkdir -p "$build"
say "Building the harnesses in $build (log: $log)"
{
  cmake -S "$repository" -B "$build" -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang -DAGS_FUZZERS=ON \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 &&
    cmake --build "$build" -j"${AGS_JOBS:-$(nproc)}" --target fuzzers
} >"$log" 2>&1 || { tail -n 20 "$log" >&2; fail "the build failed"; }
python3 -B "$repository/test/fuzz/make_seeds.py" "$build/seeds"

# Some harnesses write files into memory; all logs of libraries are silenced by the harnesses themselves.
export ASAN_OPTIONS="detect_leaks=1:allocator_may_return_null=1:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}"
export ROS_HOME="$build/ros_home"
mkdir -p "$build/findings" "$build/logs"
if [ ${#only[@]} = 0 ]; then
  for source in "$repository"/test/fuzz/*_fuzz.cpp; do only+=("$(basename "$source" _fuzz.cpp)"); done
fi

table="$(printf '%-16s %12s %10s %8s  %s' harness executions per_second corpus verdict)"
found=false
for name in "${only[@]}"; do
  say "$name"
  corpus="$build/corpus/$name"
  inputs=("$corpus" "$build/seeds/$name")
  [ -d "$repository/test/fuzz/findings/$name" ] && inputs+=("$repository/test/fuzz/findings/$name")
  mkdir -p "$corpus"
  start=$(date +%s)
  verdict=clean
  "$build/test/fuzz/fuzz_$name" "${limit[@]}" -timeout=20 -rss_limit_mb=3000 -max_len=16384 -print_final_stats=1 \
    -artifact_prefix="$build/findings/$name-" "${inputs[@]}" >"$build/logs/$name.log" 2>&1 ||
    { verdict="FOUND SOMETHING: $build/logs/$name.log"; found=true; }
  executions="$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/logs/$name.log")"
  seconds=$(($(date +%s) - start))
  row="$(printf '%-16s %12s %10s %8s  %s' "$name" "${executions:-?}" \
    "$((${executions:-0} / (seconds > 0 ? seconds : 1)))" "$(find "$corpus" -type f | wc -l)" "$verdict")"
  echo "$row"
  table+=$'\n'"$row"
done

say "Result"
echo "$table"
if $found; then
  fail "a harness found something; repeat it with $build/test/fuzz/fuzz_NAME FILE, FILE being one of $build/findings"
fi
