#!/usr/bin/env bash
# Installs rtf into a temporary folder and uses it as a stranger does: a project
# outside the checkout is built against the installed CMake package and run by
# the installed rtf, which has no environment to find the checkout by. Where
# the kernel lets us, the checkout is hidden from it altogether.

. "$(dirname "$0")/../../tools/env.sh"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

PREFIX=$prefix DESTDIR='' tools/install.sh
cp -R tests/install/downstream "$work/project"

for file in bin/rtf libexec/rtf/rtf-host-native libexec/rtf/rtf-host-lua share/man/man1/rtf.1 \
  share/man/man1/rtf-run.1 share/bash-completion/completions/rtf share/zsh/site-functions/_rtf \
  share/fish/vendor_completions.d/rtf.fish share/rtf/spec/suite.md share/rtf/schemas/event.json \
  share/doc/rtf/README.md; do
  [ -s "$prefix/$file" ] || die "$file was not installed"
done

# The stranger's session: only what a login shell has, and the installed rtf.
cat >"$work/session.sh" <<'SESSION'
set -eux
cmake -S project -B project/build -DCMAKE_PREFIX_PATH="$PWD/prefix"
cmake --build project/build
prefix/bin/rtf --version
status=0
RTF_PLUGIN_PATH=project/build prefix/bin/rtf run project/suite.xml >output.txt 2>&1 || status=$?
cat output.txt
test "$status" -eq 1
status=0
prefix/bin/rtf show latest >shown.txt || status=$? # the run's own exit code
test "$status" -eq 1
for name in CppTest LuaTest PythonTest FailingTest; do grep -q "$name" shown.txt; done
SESSION

session=(env -i "PATH=$(dirname "$(command -v python3)"):/usr/bin:/bin" "HOME=$work" LC_ALL=C.UTF-8
  bash "$work/session.sh")
cd "$work"
if unshare --map-root-user --mount true 2>/dev/null; then
  # shellcheck disable=SC2016 # expanded by the inner shell
  unshare --map-root-user --mount bash -c '
    mount -t tmpfs none "$1" && [ ! -e "$1/Cargo.toml" ] || exit 9
    shift
    exec "$@"' hide "$ROOT" "${session[@]}"
else
  say "note: no mount namespaces here: the checkout is not hidden, only searched for"
  "${session[@]}"
fi

for program in bin/rtf libexec/rtf/rtf-host-native libexec/rtf/rtf-host-lua; do
  ! grep -q -a -F -e "$ROOT/sdk" -e "$ROOT/target" "$prefix/$program" ||
    die "$program knows where the checkout is"
done

verdict() {
  python3 - "$work/rtf-results/latest/events.jsonl" "$1" <<'PYTHON'
import json, sys

events = [json.loads(line) for line in open(sys.argv[1])]
tests = {event["test"]: event["name"] for event in events if event["type"] == "test-planned"}
for event in events:
    if event["type"] == "test-finished" and tests[event["test"]] == sys.argv[2]:
        print(event["verdict"])
PYTHON
}
for name in CppTest LuaTest PythonTest; do
  [ "$(verdict $name)" = passed ] || die "$name: $(verdict $name), expected passed"
done
[ "$(verdict FailingTest)" = failed ] || die "FailingTest: $(verdict FailingTest), expected failed"

PREFIX=$prefix DESTDIR='' "$ROOT/tools/uninstall.sh"
[ ! -e "$prefix" ] || [ -z "$(find "$prefix" -type f)" ] ||
  die "left behind by make uninstall: $(find "$prefix" -type f | tr '\n' ' ')"
