#!/bin/bash
# Builds the matching and guidance libraries for 64-bit ARM, runs their tests under qemu, and compares disparities of
# NEON with those of this machine's SIMD, bit for bit.
#   scripts/test_neon.sh [--checksums-only]
# Nothing is installed for ARM: its packages are unpacked into the build folder.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

tests=true
for option in "$@"; do
  case "$option" in
    --checksums-only) tests=false ;;
    *) fail "there is no option $option; usage: test_neon.sh [--checksums-only]" ;;
  esac
done
for program in aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v $program >/dev/null || fail "$program is missing: apt-get install g++-aarch64-linux-gnu qemu-user"
done

build="${AGS_NEON_BUILD_DIR:-$repository/build_neon}"
sysroot="$build/sysroot"
libraries="$sysroot/usr/lib/aarch64-linux-gnu"
jobs="${AGS_JOBS:-$(nproc)}"
mkdir -p "$build"

if [ ! -f "$sysroot/complete" ]; then
  say "Unpacking the ARM packages into $sysroot"
  # An apt of its own, which believes that this is an ARM machine with nothing installed.
  apt="$build/apt"
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$sysroot"
  : >"$apt/status"
  cat >"$apt/apt.conf" <<END
#clear APT::Architectures;
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Sandbox::User "root";
Debug::NoLocking "true";
Dir::State "$apt";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
END
  export APT_CONFIG="$apt/apt.conf"
  apt-get update -qq
  apt-get install -y -qq --download-only --no-install-recommends libopencv-core-dev libopencv-imgproc-dev \
    libopencv-calib3d-dev libopencv-features2d-dev libopencv-flann-dev libhwy-dev libgtest-dev libgeographiclib-dev libeigen3-dev
  for package in "$apt"/cache/archives/*.deb; do
    case "$(basename "$package")" in
      libc6-dev_* | linux-libc-dev_* | libstdc++-*-dev_*) ;;  # those of the cross-compiler serve
      *) dpkg -x "$package" "$sysroot" ;;
    esac
  done
  rm -rf "$apt"
  unset APT_CONFIG
  touch "$sysroot/complete"
fi

say "Building for ARM in $build"
# OpenCV's own configuration file asks for all of its modules.
mkdir -p "$build/opencv"
cat >"$build/opencv/OpenCVConfig.cmake" <<END
set(OpenCV_FOUND TRUE)
set(OpenCV_VERSION 4)
set(OpenCV_INCLUDE_DIRS $sysroot/usr/include/opencv4)
foreach(module core flann imgproc features2d calib3d)
  if(NOT TARGET opencv_\${module})
    add_library(opencv_\${module} SHARED IMPORTED)
    set_target_properties(opencv_\${module} PROPERTIES IMPORTED_LOCATION $libraries/libopencv_\${module}.so
      INTERFACE_INCLUDE_DIRECTORIES "\${OpenCV_INCLUDE_DIRS}")
  endif()
endforeach()
set(OpenCV_LIBS opencv_core opencv_imgproc opencv_calib3d)
END
# qemu looks below the system root first, so the program's own paths are the target's.
emulator="qemu-aarch64;-L;$sysroot;-E;LD_LIBRARY_PATH=/usr/lib/aarch64-linux-gnu/lapack:/usr/lib/aarch64-linux-gnu/blas"
cat >"$build/aarch64.cmake" <<END
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_FIND_ROOT_PATH $sysroot)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
set(CMAKE_CROSSCOMPILING_EMULATOR "$emulator")
set(OpenCV_DIR $build/opencv)
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--allow-shlib-undefined -Wl,-rpath-link,$libraries")
END
cmake -S "$repository" -B "$build/arm64" -DCMAKE_TOOLCHAIN_FILE="$build/aarch64.cmake" -DCMAKE_BUILD_TYPE=Release
if $tests; then
  cmake --build "$build/arm64" -j"$jobs"
else
  cmake --build "$build/arm64" -j"$jobs" --target print_checksums
fi

say "Comparing disparities"
cmake -S "$repository" -B "$build_dir" -DCMAKE_BUILD_TYPE=Release >"$build/host.log"
cmake --build "$build_dir" -j"$jobs" --target print_checksums >>"$build/host.log"
host="$(find "$build_dir" -name print_checksums -type f)"
arm="$(find "$build/arm64" -name print_checksums -type f)"
# The first line is the target's name.
"$host" >"$build/host.txt"
best="$(head -n 1 "$build/host.txt")"
"$host" "$best" | tail -n +2 >"$build/expected.txt"
IFS=';' read -r -a emulate <<<"$emulator"
"${emulate[@]}" "$arm" NEON | tail -n +2 >"$build/neon.txt"
lines="$(wc -l <"$build/expected.txt")"
[ "$lines" -gt 0 ] || fail "no checksums were printed"
diff "$build/expected.txt" "$build/neon.txt" || fail "NEON gives other disparities than $best"
echo "$lines image pairs: NEON (qemu) gives the same bits as $best"

if $tests; then
  say "Testing under qemu"
  ctest --test-dir "$build/arm64" --output-on-failure --no-tests=error -R '^matching|^guidance' -j"$jobs"
fi
