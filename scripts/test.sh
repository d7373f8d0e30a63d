#!/bin/bash
# Installs what is missing, builds everything and runs every test. It ends with ctest's verdict.
#   scripts/test.sh [--no-setup]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

setup=true
for option in "$@"; do
  case "$option" in
    --no-setup) setup=false ;;
    *) fail "there is no option $option; usage: test.sh [--no-setup]" ;;
  esac
done

if $setup; then "$repository/scripts/setup.sh"; fi
say "Building"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release -DAGS_WERROR=ON
cmake --build "$build_dir" -j"$(nproc)"
cmake --build "$build_dir" -j"$(nproc)" --target tests
say "Testing"
export ROS_HOME="$build_dir/ros_home"
ctest --test-dir "$build_dir" --output-on-failure --no-tests=error -j2
