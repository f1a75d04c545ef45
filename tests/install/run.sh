#!/usr/bin/env bash
# Installs rtf into a temporary directory, builds a project outside the checkout against the
# installed CMake package, and runs it with the installed rtf. No variable leads to the
# checkout; if the kernel allows it, the checkout is hidden in a mount namespace.

. "$(dirname "$0")/../../tools/env.sh"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

PREFIX=$prefix DESTDIR='' tools/install.sh
cp -R tests/install/downstream "$work/project"
cp -R tests/install/embedded "$work/embedded"

# A repository with the SDK as it is, for FetchContent.
mkdir "$work/source"
git ls-files --cached --others --exclude-standard sdk/c sdk/cpp | xargs -d '\n' cp --parents -t "$work/source"
git -C "$work/source" init --quiet
git -C "$work/source" add .
git -C "$work/source" -c user.name=test -c user.email=test@example.org commit --quiet --message=SDK

for file in bin/rtf libexec/rtf/rtf-host-native libexec/rtf/rtf-host-lua \
  libexec/rtf/rtf-host-framework libexec/rtf/rtf-host-signals libexec/rtf/rtf-host-faults share/man/man1/rtf.1 \
  share/man/man1/rtf-run.1 share/bash-completion/completions/rtf share/zsh/site-functions/_rtf \
  share/fish/vendor_completions.d/rtf.fish share/doc/rtf/spec/suite.md share/rtf/spec/suite.xsd share/rtf/schemas/event.json \
  lib/cmake/rtf/rtf-config.cmake include/robottestingframework/TestCase.h include/rtf1/TestCase.h \
  share/rtf/python/robottestingframework.py share/rtf/ruby/lib/rtf/host.rb \
  share/rtf/ada/robottestingframework.gpr share/rtf/ada/src/robottestingframework.ads \
  include/rtf/session.hpp include/rtf/cppunit.hpp include/rtf/internal/SessionReports.hpp \
  libexec/rtf/librtf-cppunit.so libexec/rtf/librtf-fork-server.so libexec/rtf/librtf-report.so share/rtf/ada/rtf_aunit.gpr share/rtf/ada/aunit/rtf_aunit.ads \
  share/rtf/ament/ament_cmake_rtf/package.xml \
  share/doc/rtf/README.md share/doc/rtf/docs/images/live.png share/doc/rtf/examples/07-levels/rtf.toml; do
  [ -s "$prefix/$file" ] || die "$file was not installed"
done

python3 tools/check_links.py "$prefix/share/doc/rtf"

# A session with the environment of a login shell and the installed rtf.
cat >"$work/session.sh" <<'SESSION'
set -eux
cmake -S project -B project/build -DCMAKE_PREFIX_PATH="$PWD/prefix"
cmake --build project/build
prefix/bin/rtf --version
prefix/bin/rtf doctor dll lua python ros2shm # ros2shm is a fixture
status=0
RTF_PLUGIN_PATH=project/build prefix/bin/rtf run project/suite.xml >output.txt 2>&1 || status=$?
cat output.txt
test "$status" -eq 1
status=0
prefix/bin/rtf show latest >shown.txt || status=$? # the run's own exit code
test "$status" -eq 1
for name in CppTest LuaTest PythonTest FailingTest; do grep -q "$name" shown.txt; done
prefix/bin/robottestingframework-testrunner --version
status=0
RTF_PLUGIN_PATH=project/build prefix/bin/robottestingframework-testrunner --suite project/suite.xml \
  >output.txt 2>&1 || status=$?
cat output.txt
test "$status" -eq 1
grep -q 'Number of failed test cases  : 1' output.txt
grep -q '^Test case CppTest passed!$' result.txt
cd project/build
ctest --show-only=json-v1 >../../ctest.json
ctest --label-regex '^bench$' --parallel 2 >../../ctest.txt && exit 1 # FailingTest is in the suite
cat ../../ctest.txt
for name in CppTest all all/CppTest all/LuaTest all/PythonTest all:suite; do
  grep -E "Test +#[0-9]+: $name .*Passed" ../../ctest.txt
done
grep -E 'Test +#[0-9]+: all/FailingTest .*Failed' ../../ctest.txt
mv CppTest.so away.so
ctest --output-on-failure >../../missing.txt && exit 1 # a plug-in is missing
grep -E 'Test +#[0-9]+: all .*Failed' ../../missing.txt
grep 'there is no plug-in `CppTest`' ../../missing.txt
cd ../..

# The SDK without an installation, and the installed rtf in PATH.
PATH=$PWD/prefix/bin:$PATH
for how in subdirectory fetch; do
  cmake -S embedded -B "embedded-$how" -D HOW="$how" -D SDK_SOURCE="$PWD/source"
  cmake --build "embedded-$how"
  ctest --test-dir "embedded-$how" --output-on-failure | tee embedded.txt
  grep -E 'Test +#[0-9]+: CppTest .*Passed' embedded.txt
  grep -E 'Test +#[0-9]+: suite/OldTest .*Passed' embedded.txt
done
grep -q "^rtf_EXECUTABLE:FILEPATH=$PWD/prefix/bin/rtf$" embedded-fetch/CMakeCache.txt

# A new project, and its CI jobs.
test "$(rtf cmake-dir)" = "$PWD/prefix/lib/cmake"
test "$(rtf ada-dir)" = "$PWD/prefix/share/rtf/ada"
rtf new suite --language cpp elbow >new.txt
bash -eux <(sed '1,/^next:/d' new.txt)
cd elbow
rtf init
# Each job's shell steps, except the download of rtf.
ruby -r yaml -e '
  workflow = YAML.load_file(".github/workflows/rtf.yml")
  puts workflow["jobs"]["test"]["steps"].filter_map { |step| step["run"] }' >../github.sh
ruby -r yaml -e 'puts YAML.load_file(".gitlab/rtf.yml")["rtf"]["script"]' >../gitlab.sh
export RTF_PLUGIN_PATH=build GITHUB_STEP_SUMMARY=$PWD/summary.md
for job in github gitlab; do
  rm -rf build junit.xml
  grep -q '^pip install robot-testing-framework$' "../$job.sh"
  bash -eux <(grep -v '^pip install' "../$job.sh")
  grep -q '<testsuites .*tests="1" .*failures="0"' junit.xml
done
test -s summary.md
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

for program in bin/rtf libexec/rtf/rtf-host-{native,lua,framework,signals}; do
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

python3 - "$work/ctest.json" <<'PYTHON'
import json, sys

suite = {"LABELS": ["bench", "slow"]}
# rtf stops a run after its TIMEOUT; CTest kills it 90 s later.
wanted = {
    "all": suite | {"RESOURCE_LOCK": ["robot", "table"], "TIMEOUT": 210.0},
    "all/CppTest": suite | {"LABELS": ["bench", "quick", "slow"]},
    "all/LuaTest": suite,
    "all/PythonTest": suite,
    "all/FailingTest": suite,
    "all:suite": suite,
    "CppTest": {"LABELS": ["bench"], "RESOURCE_LOCK": ["robot"], "TIMEOUT": 150.0},
}
for test in json.load(open(sys.argv[1]))["tests"]:
    got = {entry["name"]: entry["value"] for entry in test["properties"]}
    for name, value in wanted.pop(test["name"]).items():
        assert got[name] == value, f"{test['name']}: {name} is {got[name]}, expected {value}"
assert not wanted, f"missing in CTest: {wanted}"
PYTHON

PREFIX=$prefix DESTDIR='' "$ROOT/tools/uninstall.sh"
[ ! -e "$prefix" ] || [ -z "$(find "$prefix" ! -type d)" ] ||
  die "left behind by make uninstall: $(find "$prefix" ! -type d | tr '\n' ' ')"
