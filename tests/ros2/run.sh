#!/bin/sh
# Runs a script beside this one: run.sh read.py FILE, run.sh write.py FOLDER, run.sh robot.py PORT.
# Sets up a virtual environment in QUELL_ROS2_VENV (else beside this script); exits 77 (skipped) where it cannot.
here=$(cd "${0%/*}" && pwd)
venv=${QUELL_ROS2_VENV:-$here/.venv}
skip() { echo "skipped: $1" >&2; exit 77; }
script=$1
shift
case $script in
robot.py) packages=zenoh.txt modules="zenoh, rosbags, zenoh_ros2_sdk" ;;
*) packages=requirements.txt modules="rosbags, mcap_ros2" ;;
esac
# One of the packages looks for git when it is loaded, and has no need of it here.
export GIT_PYTHON_REFRESH=quiet

command -v python3 >/dev/null 2>&1 || skip "no python3 on this machine"
if ! "$venv/bin/python" -c "import $modules" >/dev/null 2>&1; then
    python3 -m venv "$venv" >/dev/null 2>&1 || skip "python3 cannot make a virtual environment in $venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r "$here/$packages" >"$venv/pip.log" 2>&1 ||
        skip "the packages of $packages cannot be installed (see $venv/pip.log)"
    "$venv/bin/python" -c "import $modules" >/dev/null 2>&1 || skip "one of $modules does not load on this machine"
fi
exec "$venv/bin/python" "$here/$script" "$@"
