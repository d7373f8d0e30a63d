# Sourced by the other scripts: where things are, and an environment in which ROS 1 runs anywhere.

repository="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
build_dir="${AGS_BUILD_DIR:-$repository/build}"

# The system's python3 sees the ROS modules; one of pyenv or conda does not.
export PATH="/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
# Bare containers have no home; ROS and matplotlib want to write into one.
if [ -z "${HOME:-}" ] || [ ! -w "${HOME:-/nonexistent}" ]; then
  HOME="${TMPDIR:-/tmp}/adaptive_grid_stereo_home_$(id -u)"
  mkdir -p "$HOME"
  export HOME
fi
export MPLBACKEND=Agg
export DEBIAN_FRONTEND=noninteractive
# All nodes run on this machine, so its host name need not resolve.
export ROS_HOSTNAME=localhost
unset ROS_IP
# Lines of a node's log appear when they are written, not when a buffer is full.
export ROSCONSOLE_STDOUT_LINE_BUFFERED=1

# Where ROS comes from /opt/ros (Ubuntu), its environment is needed to build and to run.
if [ -z "${ROS_DISTRO:-}" ] && [ -f /opt/ros/noetic/setup.bash ]; then
  set +u
  # shellcheck disable=SC1091
  . /opt/ros/noetic/setup.bash
  set -u
fi

say() { printf '\n== %s\n' "$*"; }

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# Loads the environment of the built package.
source_build() {
  set +u
  # shellcheck disable=SC1091
  . "$build_dir/devel/setup.bash"
  set -u
  export ROS_HOME="$build_dir/ros_home"
}
