# shellcheck shell=bash
# shellcheck disable=SC2154 # tools/test.sh sets `checkers` and `simulation`
# Checks of the sources. tools/test.sh sources this file.

# The project's files, including untracked ones.
files() {
  git ls-files --cached --others --exclude-standard -- "$@"
}

lint_shell() {
  files '*.sh' .ci/run | xargs -d '\n' shellcheck
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
  "$checkers/mypy" tests/fixtures/discovery/*.py
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
  "$checkers/mypy" tests/frameworks/descendants/*.py
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
