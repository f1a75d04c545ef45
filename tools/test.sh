#!/usr/bin/env bash
# Runs all checks. If a step fails, the script prints the end of its output and continues;
# build/test-logs has complete logs. The last line counts the steps. Steps with robots and
# frameworks, which mostly wait, run at the same time as the other steps that need the release build.
#
#   tools/test.sh             all steps
#   tools/test.sh quick       without steps that need middleware (ROS, YARP, …)
#   tools/test.sh lint sdk    the steps whose names contain one of these words

. "$(dirname "$0")/env.sh"

quick=false
if [ "${1:-}" = quick ]; then
  quick=true
  shift
fi
wanted=("$@")
logs=$BUILD/test-logs
mkdir -p "$logs"
# What happened, in order: `ok NAME`, `FAILED NAME` or `skipped NAME`. Steps run in two shells.
results=$logs/results.txt
: >"$results"

is_wanted() {
  local word
  [ ${#wanted[@]} -gt 0 ] || return 0
  for word in "${wanted[@]}"; do
    [[ $1 != *"$word"* ]] || return 0
  done
  return 1
}

# Ctrl-C does not reach what runs in the background of a script.
trap 'trap - INT TERM; kill -TERM 0' INT

# Runs a step: name, command.
step() {
  local name=$1 log started=$EPOCHREALTIME seconds verdict
  shift
  is_wanted "$name" || return 0
  log=$logs/${name// /-}.log
  # In the background, because bash ignores `set -e` in a condition.
  "$@" >"$log" 2>&1 </dev/null &
  if wait $!; then verdict=ok; else verdict=FAILED; fi
  seconds=$(((${EPOCHREALTIME/./} - ${started/./}) / 100000))
  {
    flock 7
    printf '%s %s\n' "$verdict" "$name" >&7
    if [ $verdict = FAILED ]; then
      printf -- '--- %s: the last lines of %s\n' "$name" "${log#"$ROOT"/}"
      tail -n 200 "$log"
    fi
    printf '%-6s  %-28s %4d.%d s\n' "$verdict" "$name" $((seconds / 10)) $((seconds % 10))
  } 7>>"$results"
}

# Why a step failed, in few lines: the Rust tests that failed and their first panics, or the end of its output.
reason_of() {
  local log=$logs/${1// /-}.log reason
  reason=$(
    grep -a '^test .* FAILED$' "$log" | head -n 20 || true
    grep -a -A 4 'panicked at' "$log" | head -n 30 || true
  )
  printf -- '--- %s: %s\n' "$1" "${log#"$ROOT"/}"
  printf '%s\n' "${reason:-$(tail -n 12 "$log")}" | cut -c 1-400
}

# The names of the steps with a verdict.
names_of() {
  sed -n "s/^$1 //p" "$results"
}

# Runs a step that needs middleware: name, middleware, command.
step_with() {
  local name=$1 middleware=$2
  shift 2
  is_wanted "$name" || return 0
  if $quick; then
    printf 'skipped %s\n' "$name" >>"$results"
  else
    step "$name" with_middleware "$middleware" "$@"
  fi
}

with_middleware() {
  local settings
  settings=$(tools/middleware.sh "$1")
  shift
  eval "$settings"
  "$@"
}

lint_shell() {
  files '*.sh' .ci/run | xargs -d '\n' shellcheck
}

# The project's files, including untracked ones.
files() {
  git ls-files --cached --others --exclude-standard -- "$@"
}

# All except the header that cbindgen generates.
lint_cpp() {
  files '*.c' '*.h' '*.cpp' '*.hpp' | grep -v -x sdk/c/include/rtf/plugin.h |
    xargs -d '\n' clang-format --style=file:sdk/.clang-format --dry-run --Werror
}

lint_python() {
  local template
  "$checkers/ruff" check examples fixtures packaging tools tests benches web/tests crates/rtf/templates
  "$checkers/ruff" format --check examples fixtures packaging tools tests benches web/tests crates/rtf/templates
  for template in crates/rtf/templates/new/python/*/; do
    "$checkers/mypy" "$template"/*.py
  done
  "$checkers/mypy" examples/01-simulated-arm/*.py tools/*.py
  "$checkers/mypy" examples/02-supervised-simulator/*.py
  "$checkers/mypy" examples/03-yarp/*.py
  "$checkers/mypy" examples/04-icub/*.py
  "$checkers/mypy" examples/05-ros1/*.py examples/05-ros1/rover/scripts/*.py
  "$checkers/mypy" examples/06-ros2/*.py
  "$checkers/mypy" examples/07-levels/*.py
  "$checkers/mypy" examples/08-cases/*.py
  "$checkers/mypy" examples/11-signals/*.py
  "$checkers/mypy" fixtures
  "$checkers/mypy" tests/fixtures/*.py tests/fixtures/ros2launch/*.py \
    tests/fixtures/orocos/*.py tests/fixtures/yarp/*.py
  "$checkers/mypy" tests/fixtures/clock/*.py tests/fixtures/replay/*.py
  "$checkers/mypy" tests/fixtures/signals/*.py tests/fixtures/proxies/*.py
  "$checkers/mypy" packaging/*.py
  "$checkers/mypy" benches/bench.py
  "$checkers/mypy" tests/predecessor/*.py
  "$checkers/mypy" tests/wheel/*.py
  "$checkers/mypy" tests/import/*.py
  "$checkers/mypy" tests/ci/*.py
  "$checkers/mypy" tests/debug/*.py
  MYPYPATH=tests/debug "$checkers/mypy" tests/operator/*.py
  "$checkers/mypy" tests/ctest/*.py
  "$checkers/mypy" tests/colcon/*.py
  "$checkers/mypy" tests/frameworks/*.py
  "$checkers/mypy" tests/frameworks/public/*.py
  "$checkers/mypy" tests/frameworks/go/own.py
  "$checkers/mypy" tests/frameworks/cargo/own.py
  "$checkers/mypy" tests/history/*.py
  "$checkers/mypy" tests/campaign/*.py
  "$checkers/mypy" tests/monitor/*.py
  "$checkers/mypy" tests/envelopes/*.py
  "$checkers/mypy" tests/golden/*.py
  "$checkers/mypy" tests/telemetry/*.py
  "$checkers/mypy" tests/executors/*.py
}

sdk_python() {
  cd sdk/python
  "$checkers/ruff" check .
  "$checkers/ruff" format --check .
  "$checkers/mypy"
  "$checkers/pytest"
}

web_api() {
  PATH="$checkers:$PATH" python3 tools/check_web_api.py "$TARGET/debug/rtf"
}

rust_docs() {
  RUSTDOCFLAGS='-D warnings' \
    cargo doc --workspace --no-deps --document-private-items --locked
}

lint_ruby() {
  (cd sdk/ruby && rubocop .)
  # Plug-ins are named after their class and described by one comment.
  files '*.rb' | grep -v '^sdk/ruby/' | xargs -d '\n' rubocop --config sdk/ruby/.rubocop.yml --except \
    Naming/FileName,Style/Documentation,Style/FrozenStringLiteralComment,Lint/BinaryOperatorWithIdenticalOperands
}

sdk_ruby() {
  local file
  cd sdk/ruby
  for file in test/*_test.rb; do
    ruby -w -Ilib -Itest "$file"
  done
  gem build --silent --output "$BUILD/robot-testing-framework.gem" \
    robot-testing-framework.gemspec
}

lint_language() {
  files '*.md' Makefile .ci/run 'tools/*' 'benches/*' 'tests/install/*' 'packaging/*' 'tests/predecessor/*' 'tests/wheel/*' 'crates/*/src/*.rs' |
    grep -v -e '\.json$' -e '^tools/check_language.py$' | xargs -d '\n' tools/check_language.py
}

suites_are_valid() {
  # XML files in subdirectories of examples belong to the middleware.
  local suites campaigns
  suites=$(files ':(glob)examples/*/*.xml' 'crates/rtf/templates/*.xml' 'tests/install/*.xml' 'tests/wheel/*.xml' 'tests/fixtures/*/suite.xml' 'tests/frameworks/*/suite.xml' \
    'tests/ctest/project/arm.xml' 'tests/colcon/workspace/src/*/test/*.xml' \
    'tests/fixtures/yarp/suites/*.xml' 'tests/fixtures/ros1/*.xml' 'tests/fixtures/clock/*.xml' \
    'tests/fixtures/replay/*.xml' 'tests/fixtures/signals/*.xml' 'tests/fixtures/proxies/*.xml')
  campaigns=$(xargs -d '\n' grep -l '^<campaign' <<<"$suites")
  grep -vxF "$campaigns" <<<"$suites" | xargs -d '\n' xmllint --noout --schema spec/suite.xsd
  xargs -d '\n' xmllint --noout --schema spec/campaign.xsd <<<"$campaigns"
}

# Unit tests of the fixture managers.
fixtures_python() {
  "$checkers/pytest" -q -p no:cacheprovider tests/fixtures
}

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

# The tests of a package on PyPI, compared with pytest's own report.
public_pytest() {
  local interpreter
  interpreter=$(tools/venv.sh pytest)/python
  python3 tests/frameworks/public/pytest_boltons.py "$TARGET/release/rtf" "$interpreter"
}

example_09() {
  local type settings build=$BUILD/examples/09-other-frameworks
  for type in gtest catch2 cppunit aunit junit; do
    settings=$(tests/frameworks/build.sh "$type")
    eval "$settings"
  done
  rtf_DIR=$ROOT/sdk/cpp/cmake/rtf \
    GPR_PROJECT_PATH=$ROOT/sdk/ada examples/09-other-frameworks/build.sh "$build"
  PATH="$simulation:$PATH" RTF_PYTHON=$checkers/python RTF_PLUGIN_PATH=$build \
    python3 tools/check_example_09.py "$TARGET/release/rtf" examples/09-other-frameworks
}

# GoogleTest's own tests, compared with its own report.
public_gtest() {
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages googletest cmake g++
  python3 tests/frameworks/public/gtest_googletest.py "$TARGET/release/rtf"
}

# `rtf import` of a colcon workspace with packages of ament and plain CMake.
import_colcon() {
  local colcon
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake ament-cmake-googletest ament-cmake-pytest libgtest-dev cmake g++
  colcon=$(tools/venv.sh colcon)
  PATH="$colcon:$PATH" RTF_PYTHON=$colcon/python \
    python3 tests/import/check.py "$TARGET/release/rtf" "$BUILD/import"
}

# `rtf_add_suite`: one run of a suite has the results of its CTest tests.
suites_in_ctest() {
  python3 tests/ctest/check.py "$TARGET/release/rtf" sdk/cpp/cmake/rtf "$BUILD/ctest"
}

# `ament_add_rtf_suite` in a colcon workspace with packages of ament and Python.
suites_in_colcon() {
  local colcon
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake cmake g++
  colcon=$(tools/venv.sh colcon)
  PATH="$colcon:$PATH" RTF_PYTHON=$colcon/python \
    python3 tests/colcon/check.py "$TARGET/release/rtf" sdk/cpp/cmake/rtf "$BUILD/colcon"
}

# The tutorial, with the installed rtf and real nodes.
tutorial_ros2_workspace() {
  local colcon prefix=$BUILD/tutorial/prefix
  # shellcheck source=/dev/null
  . tools/packages.sh
  need_packages ament-cmake cmake g++
  colcon=$(tools/venv.sh colcon)
  PREFIX=$prefix DESTDIR='' tools/install.sh
  # Python is that of rclpy; colcon has its own.
  mkdir -p "$BUILD/tutorial/bin"
  ln -sf "$colcon/colcon" "$BUILD/tutorial/bin/colcon"
  PATH="$BUILD/tutorial/bin:$PATH" \
    python3 tests/colcon/tutorial.py "$prefix" "$BUILD/tutorial/workspace"
}

# The corpus of a test framework, see tests/frameworks/check.py.
framework() {
  local settings
  settings=$(tests/frameworks/build.sh "$1")
  eval "$settings"
  python3 tests/frameworks/check.py "$TARGET/release/rtf" "$1"
}

# The GitHub action, the GitLab template and the Jenkinsfile: their shell steps are run.
ci_helpers() {
  local python
  tools/actionlint.sh packaging/action/example.yml
  python=$(tools/venv.sh ci)/python
  "$python" tests/ci/check.py "$TARGET/release/rtf"
}

# Sessions with the debuggers of each language on a pseudo-terminal.
debugging() {
  mkdir -p "$BUILD/debug"
  c++ -std=c++17 -g -O0 -shared -fPIC -Isdk/cpp/include -Isdk/c/include tests/debug/reach.cpp \
    -o "$BUILD/debug/libreach.so"
  python3 tests/debug/check.py "$TARGET/release/rtf" "$BUILD/debug"
}

# Questions of tests, answered on a pseudo-terminal.
operator() {
  python3 tests/operator/check.py "$TARGET/release/rtf"
}

# Metrics and traces, read by Prometheus and by OpenTelemetry's collector and its decoder.
telemetry() {
  local prometheus collector decoder=$BUILD/telemetry/telemetry
  prometheus=$(tools/prometheus.sh)
  collector=$(tests/telemetry/collector/build.sh)
  mkdir -p "$BUILD/telemetry"
  PATH=$(tools/go.sh):$PATH
  (cd tests/telemetry && GOTOOLCHAIN=local quietly go build -o "$decoder" .)
  "$(tools/venv.sh telemetry)/python" tests/telemetry/check.py "$TARGET/debug/rtf" "$decoder" \
    "$prometheus" "$collector"
}

# Change points, compared with those of Apache Otava and with planted changes.
history_change_points() {
  local python
  # Without dependencies: see tools/requirements-history.txt.
  python=$(PIP_NO_DEPS=1 tools/venv.sh history)/python
  cargo build --quiet --locked -p rtf-history --example change_points
  "$python" tests/history/check.py "$TARGET/debug/examples/change_points"
}

# What the unit tests of campaigns compare with: results of SciPy and savvi, and lists of episodes by
# a second implementation.
campaign_oracle() {
  local python
  python=$(PIP_NO_DEPS=1 tools/venv.sh history)/python
  "$python" tests/campaign/oracle.py --check tests/campaign/scipy.json
  "$python" tests/campaign/episodes.py --check crates/rtf-campaign/tests/campaign/golden/*.xml
  python=$(tools/venv.sh sequential)/python
  "$python" tests/campaign/sequential.py tests/campaign/scipy.json
}

# Robustness of random formulas, compared with rtamt and with a second implementation.
monitor_oracle() {
  local python
  python=$(PIP_NO_DEPS=1 tools/venv.sh monitor)/python
  cargo build --quiet --locked -p rtf-monitor --example robustness
  "$python" tests/monitor/oracle.py "$TARGET/debug/examples/robustness"
}

# Limits of robot models, compared with those of MuJoCo.
envelope_oracle() {
  "$(tools/venv.sh icub)/python" tests/envelopes/oracle.py "$TARGET/debug/rtf"
}

# Distances of dynamic time warping, compared with those of dtaidistance, and differences of
# pictures, compared with those of scikit-image.
golden_oracle() {
  local python
  python=$(tools/venv.sh golden)/python
  cargo build --quiet --locked -p rtf-golden --examples
  "$python" tests/golden/oracle.py "$TARGET/debug/examples/warp"
  "$python" tests/golden/pictures.py "$TARGET/debug/examples/similarity"
}

# Parquet files of the history, read by Apache Arrow.
history_export() {
  "$(tools/venv.sh export)/python" tests/history/export.py "$TARGET/debug/rtf"
}

# The history in a PostgreSQL server, which the test starts and ends.
history_postgres() {
  local bin
  # shellcheck source=tools/packages.sh
  . tools/packages.sh
  need_packages postgresql
  bin=$(printf '%s\n' /usr/lib/postgresql/*/bin | sort -V | tail -n 1)
  RTF_POSTGRES_BIN=$bin cargo test --quiet --locked -p rtf-history --test postgres -- --ignored
}

# `--executor slurm` with a real cluster, which needs root.
executor_slurm() {
  tools/slurm.sh python3 tests/executors/check_slurm.py "$TARGET/debug/rtf"
}

# `--executor kubernetes` with a real control plane, and nodes that need root.
executor_kubernetes() {
  local programs
  programs=$(tests/executors/control_plane/build.sh)
  unshare --mount --pid --fork --mount-proc --kill-child \
    python3 tests/executors/check_kubernetes.py "$TARGET/release/rtf" "$programs"
}

# What is submitted to Kubernetes, against its schemas.
kubernetes_manifests() {
  local programs
  programs=$(tests/executors/control_plane/build.sh)
  "$(tools/venv.sh kubernetes)/python" tests/executors/manifests.py "$TARGET/release/rtf" "$programs"
}

# Runs an npm script of the page.
in_web() {
  tools/web.sh modules
  cd web
  PATH=$("$ROOT/tools/node.sh"):$PATH npm run --silent "$@"
}

tools/bootstrap.sh test
checkers=$(tools/venv.sh test)
simulation=$(tools/venv.sh demo)

step 'lint shell' lint_shell
step 'lint rust format' cargo fmt --all --check -- --color never
step 'lint c++ format' lint_cpp
step 'lint python' lint_python
step 'lint versions' tools/version.py
step 'lint ruby' lint_ruby
step 'lint suites' suites_are_valid
step 'lint language' lint_language
step 'security promises' tools/check_security.py
step 'supply chain' tools/supply_chain.sh
step 'lint page' in_web check
step 'lint rust' cargo clippy --workspace --all-targets --locked -- -D warnings
step 'lint rust docs' rust_docs
step 'generated schemas' cargo run --quiet --locked -p xtask -- schemas --check
step 'generated c header' cargo run --quiet --locked -p xtask -- header --check
step 'page' tools/web.sh
step 'page unit tests' in_web test
step 'vscode' tools/vscode.sh
step 'build' cargo build --workspace --locked
step 'sdk python' sdk_python
step 'sdk ruby' sdk_ruby
step 'fixtures python' fixtures_python
step 'build release' tools/build.sh
step 'instruction counts' tools/counts.py "$TARGET/release/rtf-counts"
step 'example 01 plug-ins' tools/plugins.sh examples/01-simulated-arm
robots_and_frameworks() {
  step 'example 01' example_01
  step 'example 02' example_02
  step 'fixture mcap' fixture_mcap
  step_with 'example 03' yarp example_03
  step_with 'fixture yarp' yarp fixture_yarp
  step_with 'clock yarp' yarp clock_yarp
  step_with 'fixture replay yarp' yarp fixture_replay_yarp
  step_with 'example 04' yarp example_04
  step_with 'example 05' ros1 example_05
  step_with 'clock ros1' ros1 clock_ros1
  step_with 'fixture replay ros1' ros1 fixture_replay_ros1
  step_with 'guide replay' ros1 guide_replay
  step_with 'signals ros1' ros1 signals_of ros
  step_with 'signals yarp' yarp signals_of yarp
  step_with 'proxies ros1' ros1 proxies_of ros
  step_with 'proxies yarp' yarp proxies_of yarp
  step_with 'example 06' ros2 example_06
  step 'example 07' example_07
  step 'example 08' example_08
  step 'example 10' example_10
  step 'example 11' example_11
  step 'signals of tests' signals_of_tests
  # The first step builds Kubernetes, which takes minutes.
  step 'kubernetes manifests' kubernetes_manifests
  step 'executor kubernetes' executor_kubernetes
  step_with 'clock ros2' ros2 clock_ros2
  step_with 'signals ros2' ros2 signals_of ros2
  step_with 'proxies ros2' ros2 proxies_of ros2
  step_with 'fixture ros2launch' ros2 fixture_ros2launch
  step_with 'fixture orocos' orocos fixture_orocos
  step 'framework gtest' framework gtest
  step 'framework gtest public' public_gtest
  step 'import colcon' import_colcon
  step 'suites in ctest' suites_in_ctest
  step 'suites in colcon' suites_in_colcon
  step_with 'tutorial ros2 workspace' ros2 tutorial_ros2_workspace
  step 'framework catch2' framework catch2
  step 'framework doctest' framework doctest
  step 'framework boost' framework boost
  step 'framework cppunit' framework cppunit
  step 'framework aunit' framework aunit
  step 'framework pytest' framework pytest
  step 'framework pytest public' public_pytest
  step 'framework unittest' framework unittest
  step 'framework ctest' framework ctest
  step 'framework tap' framework tap
  step 'framework program' framework program
  step_with 'framework rostest' ros1 framework rostest
  step 'example 09' example_09
  step 'framework junit' framework junit
  step 'framework go' framework go
  step 'framework public go' tests/frameworks/public/go.sh "$TARGET/release/rtf"
  step 'framework cargo' framework cargo
}
robots_and_frameworks &
robots=$!

# Also builds the plug-ins in sdk/c and sdk/cpp, with cc and c++.
# `nohup make test` passes an ignored SIGHUP on, and `rtf` respects it; some tests send SIGHUP.
step 'rust tests' env --default-signal=HUP cargo test --workspace --locked --no-fail-fast
# The libraries are compiled once more, with the counters of libFuzzer; what they depend on is that of
# the release build.
step 'fuzz' tools/fuzz.sh --seconds 10 --seed 1
step 'web api' web_api
step 'history change points' history_change_points
step 'campaign oracle' campaign_oracle
step 'monitor oracle' monitor_oracle
step 'envelope oracle' envelope_oracle
step 'golden oracle' golden_oracle
step 'history export' history_export
step 'history in PostgreSQL' history_postgres
step 'telemetry' telemetry
step 'executor slurm' executor_slurm
step 'debugging' debugging
step 'degraded machine' python3 tests/degraded/check.py "$TARGET/release/rtf"
# The tests with valgrind take minutes: `make sanitizers` runs all.
step 'sanitizers' tools/sanitizers.sh sanitizer
step 'operator' operator
step 'ci helpers' ci_helpers
step 'guide' env RTF_PYTHON="$checkers/python" tools/check_docs.py "$TARGET/release/rtf" README.md \
  docs/tutorials/{first-test,first-fixture,cpp-plugin}.md docs/explanation/isolation.md \
  docs/how-to/{writing-tests,simulation-time,recorders,real-robot,signals,envelopes,golden,faults}.md \
  docs/how-to/migrating-{rtf2,launch-testing,pytest,robot-framework}.md docs/reference/junit.md
step 'guide commands' tools/check_running.py "$TARGET/release/rtf" \
  docs/how-to/{running,flaky-tests,soak,parallel,profiles,doctor,sharding,history}.md
step 'guide requests' tools/check_web_page.py "$TARGET/release/rtf"
step 'guide build' tools/docs.sh "$TARGET/release/rtf"
step 'page in a browser' tools/web-tests.sh
step 'vscode in a browser' tools/vscode.sh browser
step 'installed copy' tests/install/run.sh
step 'wheel' tests/wheel/run.sh
step 'packages deb' tests/install/deb.sh
step 'front door' tools/front_door.sh
step 'predecessor command line' tests/predecessor/run.sh command
step 'predecessor compared' tests/predecessor/run.sh compare
step 'predecessor ours' tests/predecessor/run.sh ours

wait $robots || die "the steps with robots and frameworks ended early"
mapfile -t passed < <(names_of ok)
mapfile -t failed < <(names_of FAILED)
mapfile -t skipped < <(names_of skipped)
for name in "${failed[@]}"; do
  reason_of "$name"
done
[ ${#failed[@]} -eq 0 ] || printf 'failed: %s\n' "${failed[@]}"
if [ ${#skipped[@]} -gt 0 ]; then
  printf 'skipped, because they need middleware: %s\n' "$(printf '%s, ' "${skipped[@]}" | sed 's/, $//')"
fi
printf '%d passed, %d failed\n' ${#passed[@]} ${#failed[@]}
[ ${#failed[@]} -eq 0 ] || exit 1
[ ${#passed[@]} -gt 0 ] || die "no step has a name that contains: $*"
