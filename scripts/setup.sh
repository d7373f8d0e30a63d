#!/bin/bash
# Installs what is missing to build, test and run the package, with apt, and asks nothing.
#   scripts/setup.sh [--rviz]
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

# Groups of packages, each with the reason for it.
reasons=()
packages=()
need() {
  reasons+=("$1")
  shift
  packages+=("$*")
}

if [ "${ROS_DISTRO:-}" = noetic ]; then
  need "to compile" build-essential cmake
  need "ROS: messages, nodelets, bags, launching, tests" \
    ros-noetic-catkin ros-noetic-roscpp ros-noetic-rospy ros-noetic-nodelet ros-noetic-pluginlib \
    ros-noetic-rosbag ros-noetic-roslaunch ros-noetic-rostest ros-noetic-topic-tools \
    ros-noetic-cv-bridge ros-noetic-image-geometry ros-noetic-image-transport \
    ros-noetic-message-filters ros-noetic-dynamic-reconfigure ros-noetic-diagnostic-updater \
    ros-noetic-tf2-ros ros-noetic-stereo-msgs ros-noetic-nav-msgs
  need "to rectify images, to make point clouds, and to compare with" \
    ros-noetic-image-proc ros-noetic-stereo-image-proc
  need "geodesy (GPS fixes)" libgeographic-dev
else
  need "to compile" build-essential cmake
  need "to build a ROS package, its messages and parameters" \
    catkin ros-message-generation python3-dynamic-reconfigure libdynamic-reconfigure-config-init-mutex-dev
  need "ROS libraries that the nodelet uses" \
    libroscpp-dev libnodelet-dev libnodeletlib-dev libimage-transport-dev libcv-bridge-dev \
    libimage-geometry-dev libmessage-filters-dev libdiagnostic-updater-dev libtf2-ros-dev \
    libtf2-geometry-msgs-dev librosbag-dev librosbag-storage-dev libtopic-tools-dev
  need "ROS messages" \
    libstd-msgs-dev ros-std-msgs libgeometry-msgs-dev ros-geometry-msgs libsensor-msgs-dev \
    ros-sensor-msgs libstereo-msgs-dev ros-stereo-msgs libnav-msgs-dev ros-nav-msgs \
    libdiagnostic-msgs-dev libtf2-msgs-dev ros-tf2-msgs
  need "to launch, record and play" \
    libnodeletlib-tools python3-roslaunch python3-rosbag python3-rospy rosout rosbash rospack-tools \
    topic-tools tf2-tools python3-rostopic python3-rosnode python3-rosmsg python3-rosservice
  need "messages for Python" \
    python3-std-msgs python3-geometry-msgs python3-sensor-msgs python3-stereo-msgs python3-nav-msgs \
    python3-diagnostic-msgs python3-tf2-msgs
  need "to rectify images, to make point clouds, and to compare with" \
    ros-image-proc libimage-proc-dev ros-stereo-image-proc libstereo-image-proc-dev
  need "geodesy (GPS fixes)" libgeographiclib-dev
  need "ROS tests" librostest-dev python3-rostest
fi
need "images, vectors, command lines, YAML, JSON" \
  libopencv-dev libeigen3-dev libboost-program-options-dev libboost-thread-dev libyaml-cpp-dev libbz2-dev \
  nlohmann-json3-dev
need "SIMD for every CPU (Google Highway)" libhwy-dev
need "ray casting for the simulated flight" libembree-dev
need "unit tests and benchmarks" libgtest-dev libbenchmark-dev
need "pictures of a flight" python3-numpy python3-matplotlib python3-opencv python3-yaml
for option in "$@"; do
  case "$option" in
    --rviz)
      if [ "${ROS_DISTRO:-}" = noetic ]; then
        need "to watch the flight" ros-noetic-rviz
      else
        need "to watch the flight" rviz
      fi
      ;;
    *) fail "there is no option $option; usage: setup.sh [--rviz]" ;;
  esac
done

command -v apt-get >/dev/null ||
  fail "apt-get is missing: install by hand, under your system's names: ${packages[*]}"

as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo --preserve-env=DEBIAN_FRONTEND "$@"
  else
    fail "packages are missing and neither root nor sudo is at hand; as root run: $*"
  fi
}

is_installed() {
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for i in "${!packages[@]}"; do
  lacking=()
  for package in ${packages[$i]}; do
    is_installed "$package" || lacking+=("$package")
  done
  [ ${#lacking[@]} = 0 ] && continue
  [ ${#missing[@]} = 0 ] && say "Packages to install"
  printf '%s:\n    %s\n' "${reasons[$i]}" "${lacking[*]}"
  missing+=("${lacking[@]}")
done

if [ ${#missing[@]} -gt 0 ]; then
  as_root apt-get update -qq
  # Highway is wanted, not needed: systems before 2022 do not have it, and the matcher is slower there.
  available=()
  for package in "${missing[@]}"; do
    if apt-cache show "$package" >/dev/null 2>&1; then
      available+=("$package")
    elif [ "$package" = libhwy-dev ]; then
      echo "libhwy-dev is not to be had here: the matcher will run without hand-tuned SIMD"
    else
      fail "apt knows no package $package. Debian 12 has it; on Ubuntu 20.04 set up ROS Noetic first" \
        "(http://wiki.ros.org/noetic/Installation/Ubuntu)"
    fi
  done
  if [ ${#available[@]} -gt 0 ]; then
    as_root apt-get install -y -qq -o Dpkg::Use-Pty=0 --no-install-recommends "${available[@]}"
  fi
fi

# roslaunch looks up "localhost", which bare containers may lack.
if ! getent hosts localhost >/dev/null; then
  echo "/etc/hosts has no localhost, which ROS needs: adding it"
  as_root sh -c 'echo "127.0.0.1 localhost" >> /etc/hosts'
fi
