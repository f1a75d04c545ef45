# shellcheck shell=bash
# shellcheck disable=SC2154 # tools/test.sh sets `checkers` and `simulation`
# Sessions with the built runner: a debugger, an operator, CI, the API of the page. tools/test.sh sources this file.

web_api() {
  PATH="$checkers:$PATH" python3 tools/check_web_api.py "$TARGET/debug/rtf"
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
