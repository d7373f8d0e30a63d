#!/bin/bash
# Builds with a sanitizer in a build folder of its own, and runs the tests: nearly all for "address" (with
# undefined behaviour), those of matching and guidance and of the threads around them for "thread".
#   scripts/sanitize.sh address|thread [--simd] [--quick]
# --quick builds and runs less, tests side by side: matching, guidance and the fuzzers' seeds for "address", matching
# for "thread".
# The kernels are the plain C++ ones, unless --simd is given: with a sanitizer, gcc needs many minutes for the SIMD
# ones. (scripts/fuzz.sh has those under the address sanitizer, by clang.)
# Any report of any process fails, also one of a node that a test starts.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

# The sanitizer's library has to come before all others.
unset LD_PRELOAD

usage="usage: sanitize.sh address|thread [--simd] [--quick]"
kind="${1:-}"
highway=OFF
quick=false
cores="${AGS_JOBS:-$(nproc)}"
jobs=1  # tests with nodes want the machine for themselves, lest time limits pass
for option in "${@:2}"; do
  case "$option" in
    --simd) highway=ON ;;
    --quick)
      quick=true
      jobs="$cores"
      ;;
    *) fail "there is no option $option; $usage" ;;
  esac
done
# The programs of a folder of tests are called after its files.
programs() { basename -s .cpp "$repository/test/$1"/*_test.cpp; }
case "$kind" in
  address)
    flags=address,undefined
    runtime=libasan.so
    # One starts the whole launch file, whose manager cannot be given the sanitizer's library. To the other, images
    # come in real time, too fast for plain kernels with a sanitizer in them.
    tests=(-E 'process_faults|sim_main_path')
    if $quick; then
      tests=(-R '^matching|^guidance|^fuzz')
      targets=($(programs matching) $(programs guidance | sed 's/^/guidance_/') fuzzers)
    fi
    ;;
  thread)
    flags=thread
    runtime=libtsan.so
    # Not the running node: roscpp is not built with the sanitizer, which then sees hundreds of races in it.
    tests=(-R '^matching|^guidance|gtest_(mailbox|governor|diagnostics|motion_subscriber)_test')
    if $quick; then
      tests=(-R '^matching')
      targets=($(programs matching))
    fi
    ;;
  *) fail "$usage" ;;
esac

build="${AGS_SANITIZE_BUILD_DIR:-$repository/build_$kind}"
say "Building in $build"
# With the tracking of variables gcc spends minutes on the kernels, to give up in the end.
cmake -S "$repository" -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -fno-var-tracking" -DAGS_SANITIZE="$flags" -DAGS_WITH_HIGHWAY="$highway"
if $quick; then
  cmake --build "$build" -j"$cores" --target "${targets[@]}"
else
  cmake --build "$build" -j"$cores"
  cmake --build "$build" -j"$cores" --target tests
fi

say "Testing"
reports="$build/sanitizer_reports"
rm -rf "$reports"
mkdir -p "$reports"
# A nodelet's library does not load into a manager that lacks the sanitizer's; the tests put this before it.
# Not into the whole environment, where Python would be caught too. -R: at fixed addresses, which TSan wants.
AGS_LAUNCH_PREFIX="setarch -R env LD_PRELOAD=$(gcc -print-file-name=$runtime)"
export AGS_LAUNCH_PREFIX
export ASAN_OPTIONS="log_path=$reports/asan:detect_leaks=1:halt_on_error=1"
export UBSAN_OPTIONS="log_path=$reports/ubsan:print_stacktrace=1"
export TSAN_OPTIONS="log_path=$reports/tsan:history_size=7"
export ROS_HOME="$build/ros_home"
status=0
setarch -R ctest --test-dir "$build" --output-on-failure --no-tests=error -j"$jobs" "${tests[@]}" || status=1

# rostest does not notice what its nodes report.
if [ -n "$(ls -A "$reports")" ]; then
  say "Reports"
  grep -h -E 'SUMMARY|runtime error' "$reports"/* | sort | uniq -c || true
  echo "in full: $reports"
  status=1
fi
[ $status = 0 ] && say "No reports, all tests passed" || fail "see above"
