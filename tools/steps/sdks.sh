# shellcheck shell=bash
# shellcheck disable=SC2154 # tools/test.sh sets `checkers` and `simulation`
# Tests of the SDKs and fixtures that are written in Python and Ruby. tools/test.sh sources this file.

sdk_python() {
  cd sdk/python || return
  "$checkers/ruff" check .
  "$checkers/ruff" format --check .
  "$checkers/mypy"
  "$checkers/pytest"
}

sdk_ruby() {
  local file
  cd sdk/ruby || return
  for file in test/*_test.rb; do
    ruby -w -Ilib -Itest "$file"
  done
  gem build --silent --output "$BUILD/robot-testing-framework.gem" \
    robot-testing-framework.gemspec
}

# Unit tests of the fixture managers.
fixtures_python() {
  "$checkers/pytest" -q -p no:cacheprovider tests/fixtures
}
