# shellcheck shell=bash
# shellcheck disable=SC2154 # tools/test.sh sets `checkers` and `simulation`
# Examples and fixtures with simulators and middleware. tools/test.sh sources this file.

fixture_orocos() {
  python3 tools/check_fixture_orocos.py "$TARGET/release/rtf" tests/fixtures/orocos
}

fixture_ros2launch() {
  python3 tools/check_fixture_ros2launch.py "$TARGET/release/rtf" tests/fixtures/ros2launch/suite.xml
}

example_01() {
  PATH="$simulation:$PATH" RTF_PLUGIN_PATH=$BUILD/examples/01-simulated-arm \
    python3 tools/check_example_01.py "$TARGET/release/rtf" examples/01-simulated-arm/arm.xml
}

fixture_mcap() {
  local library
  library=$(tools/venv.sh mcap)
  PATH="$library:$PATH" python3 tools/check_fixture_mcap.py "$TARGET/release/rtf"
}

example_02() {
  PATH="$simulation:$PATH" python3 tools/check_example_02.py "$TARGET/release/rtf" \
    examples/02-supervised-simulator/supervised.xml
}

clock_ros1() {
  python3 tools/check_clock.py "$TARGET/release/rtf" tests/fixtures/clock/ros.xml
}

clock_ros2() {
  python3 tools/check_clock.py "$TARGET/release/rtf" tests/fixtures/clock/ros2.xml
}

clock_yarp() {
  python3 tools/check_clock.py "$TARGET/release/rtf" tests/fixtures/clock/yarp.xml
}

fixture_yarp() {
  python3 tools/check_fixture_yarp.py "$TARGET/release/rtf" tests/fixtures/yarp/suites
}

# Debian's rospy belongs to Debian's Python, which needs the library `mcap`, too.
fixture_replay_ros1() {
  local library
  library=$(PATH=/usr/bin:$PATH tools/venv.sh mcap)
  PYTHONPATH=$("$library/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  export PYTHONPATH
  /usr/bin/python3 tools/check_fixture_replay.py "$TARGET/release/rtf" tests/fixtures/replay ros1
  /usr/bin/python3 tools/check_ended_subscriber.py
}

fixture_replay_yarp() {
  local library
  library=$(tools/venv.sh mcap)
  PATH="$library:$PATH" python3 tools/check_fixture_replay.py "$TARGET/release/rtf" \
    tests/fixtures/replay yarp
}

# The guide to replaying, with real nodes.
guide_replay() {
  local library
  library=$(PATH=/usr/bin:$PATH tools/venv.sh mcap)
  PYTHONPATH=$("$library/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))') \
    /usr/bin/python3 tools/check_docs.py "$TARGET/release/rtf" docs/how-to/replay.md
}

example_03() {
  export RTF_DIR=$ROOT/sdk/cpp/cmake/rtf RTF_PLUGIN_PATH=$BUILD/examples/03-yarp
  PATH=$RTF_PLUGIN_PATH:$PATH
  tools/plugins.sh examples/03-yarp
  python3 tools/check_example_03.py "$TARGET/release/rtf" examples/03-yarp
}

example_05() {
  tools/plugins.sh examples/05-ros1
  RTF_PLUGIN_PATH=$BUILD/examples/05-ros1 ROS_PACKAGE_PATH=$BUILD/examples/05-ros1:/usr/share \
    python3 tools/check_example_05.py "$TARGET/release/rtf" examples/05-ros1 \
    tests/fixtures/ros1/probes.xml
}

example_04() {
  tools/icub.sh python3 tools/check_example_04.py "$TARGET/release/rtf" examples/04-icub/icub.xml
}

example_06() {
  python3 tools/check_example_06.py "$TARGET/release/rtf" examples/06-ros2/{left,right}.xml
}

discovery_ros2() {
  python3 tools/check_discovery.py "$TARGET/release/rtf" tests/fixtures/discovery
}

example_07() {
  PATH="$simulation:$PATH" python3 tools/check_example_07.py "$TARGET/release/rtf" \
    examples/07-levels
}

example_08() {
  PATH="$simulation:$PATH" python3 tools/check_example_08.py "$TARGET/release/rtf" examples/08-cases
}

example_10() {
  local search
  search=$(tools/venv.sh search)
  PATH="$simulation:$PATH" python3 tools/check_example_10.py "$TARGET/release/rtf" \
    examples/10-campaign "$search/python"
}

signals_of() {
  python3 tools/check_signals.py "$TARGET/release/rtf" tests/fixtures/signals "$1"
}

proxies_of() {
  python3 tools/check_proxies.py "$TARGET/release/rtf" tests/fixtures/proxies "$1"
}

signals_of_tests() {
  local library
  library=$(tools/venv.sh mcap)
  PATH="$library:$PATH" signals_of own
}

example_11() {
  local library
  library=$(tools/venv.sh mcap)
  PATH="$library:$PATH" python3 tools/check_example_11.py "$TARGET/release/rtf" examples/11-signals
}
