#!/usr/bin/env bash
# Runs all checks. If a step fails, the script prints the end of its output and continues;
# build/test-logs has complete logs. The last line counts the steps. Steps with robots and
# frameworks, which mostly wait, run at the same time as the other steps that need the release build.
# This file lists the steps; their functions are in tools/steps.
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

for file in tools/steps/*.sh; do
  # shellcheck source=/dev/null
  . "$file"
done

# Runs an npm script of the page.
in_web() {
  tools/web.sh modules
  cd web
  PATH=$("$ROOT/tools/node.sh"):$PATH npm run --silent "$@"
}

tools/bootstrap.sh test
checkers=$(tools/venv.sh test)
simulation=$(tools/venv.sh demo)
export checkers simulation

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
  step_with 'discovery ros2' ros2 discovery_ros2
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
  step 'framework pytest projects' pytest_projects
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
