#!/usr/bin/env bash
# Installs rtf below PREFIX; with DESTDIR, below DESTDIR/PREFIX (for packages).
# tools/uninstall.sh reads the list of installed files from share/rtf/manifest.txt.
#
# PROGRAMS=DIR installs the programs in DIR, which may be for another processor, and builds
# nothing. If they do not run here, target/release/rtf prints the man pages. LIBRARIES is the
# directory of the libraries that rtf preloads, by default the same.
#
# PARTS=FILE also writes a line `part path` for each file into FILE, for Debian packages: the
# parts are `rtf`, `rtf-dev` and `robot-testing-framework-compat`.

. "$(dirname "$0")/env.sh"

PREFIX=${PREFIX:-/usr/local}
DESTDIR=${DESTDIR:-}
case $PREFIX in
  /*) ;;
  *) die "PREFIX is \`$PREFIX\`, which is not an absolute path" ;;
esac
top=$DESTDIR$PREFIX
release=$TARGET/release
programs=${PROGRAMS:-$release}
libraries=${LIBRARIES:-${PROGRAMS:-$BUILD}}

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT

part=rtf
record() {
  printf '%s\n' "$1" >>"$stage/manifest.txt"
  printf '%s %s\n' "$part" "$1" >>"$stage/parts.txt"
}

# Installs one file: mode, source, destination below the prefix.
put() {
  install -D -m "$1" "$2" "$top/$3"
  record "$3"
}

# Installs a link: target, destination below the prefix.
put_link() {
  ln -sfn "$1" "$top/$2"
  record "$2"
}

# Installs the files of a directory whose names match one of the patterns, except build
# results and caches.
put_tree() {
  local source=$1 destination=$2 names=() file
  shift 2
  for pattern in "$@"; do
    names+=(-o -name "$pattern")
  done
  while IFS= read -r file; do
    put 644 "$file" "$destination/${file#"$source"/}"
  done < <(find "$source" \
    -regex '.*/\(build\|venv\|rtf-results\|__pycache__\)' -prune \
    -o -type f \( "${names[@]:1}" \) -print | sort)
}

# Do not build under sudo: root would own files in the checkout.
if [ -z "${SUDO_USER:-}${PROGRAMS:-}" ]; then
  tools/bootstrap.sh build
  tools/build.sh
fi
printer=$programs/rtf
"$printer" --version >/dev/null 2>&1 || printer=$release/rtf
for program in "$printer" "$programs"/{rtf,rtf-host-native,rtf-host-lua,rtf-host-framework,rtf-host-signals,rtf-host-faults}; do
  [ -x "$program" ] || die "$program is missing" "run \`make build\` first"
done
if [ -e "$top" ] && [ ! -w "$top" ]; then
  die "$top cannot be written" "sudo make install, or choose another PREFIX"
fi
if [ -e "$top/share/rtf/manifest.txt" ]; then
  tools/uninstall.sh # files of an older version that the new one does not have
fi

"$printer" man "$stage/man"
for shell in bash zsh fish; do
  "$printer" completions "$shell" >"$stage/rtf.$shell"
done

put 755 "$programs/rtf" bin/rtf
put 755 "$programs/rtf-host-native" libexec/rtf/rtf-host-native
put 755 "$programs/rtf-host-lua" libexec/rtf/rtf-host-lua
put 755 "$programs/rtf-host-framework" libexec/rtf/rtf-host-framework
put 755 "$programs/rtf-host-signals" libexec/rtf/rtf-host-signals
put 755 "$programs/rtf-host-faults" libexec/rtf/rtf-host-faults
for library in librtf-fork-server.so librtf-report.so librtf-cppunit.so; do
  if [ -e "$libraries/$library" ]; then
    put 644 "$libraries/$library" "libexec/rtf/$library"
  else
    say "note: $library was not built, see docs/frameworks"
  fi
done
# The Lua SDK is part of rtf-host-lua.
put_tree sdk/python/rtf share/rtf/python/rtf '*.py' py.typed
for module in robottestingframework rtf_start; do
  put 644 "sdk/python/$module.py" "share/rtf/python/$module.py"
done
put_tree sdk/ruby/lib share/rtf/ruby/lib '*.rb'
put_tree fixtures share/rtf/fixtures '*.py' '*.json'
put 644 spec/suite.xsd share/rtf/spec/suite.xsd
put 644 spec/campaign.xsd share/rtf/spec/campaign.xsd
put_tree schemas share/rtf/schemas '*.json'
put_tree "$stage/man" share/man/man1 '*.1'
put 644 "$stage/rtf.bash" share/bash-completion/completions/rtf
put 644 "$stage/rtf.zsh" share/zsh/site-functions/_rtf
put 644 "$stage/rtf.fish" share/fish/vendor_completions.d/rtf.fish
for page in README.md ARCHITECTURE.md CHANGELOG.md CONTRIBUTING.md SECURITY.md LICENSE; do
  put 644 "$page" "share/doc/rtf/$page"
done
put_tree docs share/doc/rtf/docs '*.md' '*.png' '*.svg'
put_tree spec share/doc/rtf/spec '*.md' '*.xsd'
# What the pages lead to.
for file in deny.toml sdk/{ada,lua,python,ruby}/README.md sdk/c/include/rtf/plugin.h fixtures/needs.json schemas/openapi.json \
  packaging/action/{action,example}.yml packaging/gitlab/rtf.yml packaging/jenkins/Jenkinsfile \
  packaging/container/{Containerfile,role.yaml}; do
  put 644 "$file" "share/doc/rtf/$file"
done
put_tree examples share/doc/rtf/examples '*.md' '*.xml' '*.toml' '*.launch' '*.sh' CMakeLists.txt \
  '*.py' '*.lua' '*.rb' '*.cpp' '*.hpp' '*.ads' '*.adb' '*.gpr' '*.java'

part=rtf-dev
put_tree sdk/c/include include '*.h'
put_tree sdk/cpp/include/rtf include/rtf '*.hpp'
put_tree sdk/cpp/cmake/rtf lib/cmake/rtf '*.cmake'
put_tree packaging/ament share/rtf/ament '*.xml' '*.txt' '*.cmake'
put_tree sdk/ada/src share/rtf/ada/src '*.ads' '*.adb'
put_tree sdk/ada/aunit share/rtf/ada/aunit '*.ads' '*.adb'
put 644 sdk/ada/robottestingframework.gpr share/rtf/ada/robottestingframework.gpr
put 644 sdk/ada/rtf_aunit.gpr share/rtf/ada/rtf_aunit.gpr
for shared in Targets AddPlugin AddSuite; do
  put 644 sdk/cpp/cmake/RobotTestingFramework/RobotTestingFramework$shared.cmake \
    lib/cmake/RobotTestingFramework/RobotTestingFramework$shared.cmake
done

# The names of robot-testing-framework 1.x and 2.x.
part=robot-testing-framework-compat
put_link rtf bin/robottestingframework-testrunner
put_tree sdk/cpp/include/robottestingframework include/robottestingframework '*.h'
put_tree sdk/cpp/include/rtf1 include/rtf1 '*.h'
for package in Config ConfigVersion; do
  put 644 sdk/cpp/cmake/RobotTestingFramework/RobotTestingFramework$package.cmake \
    lib/cmake/RobotTestingFramework/RobotTestingFramework$package.cmake
done

install -D -m 644 "$stage/manifest.txt" "$top/share/rtf/manifest.txt"
[ -z "${PARTS:-}" ] || cp "$stage/parts.txt" "$PARTS"
say "installed $(wc -l <"$stage/manifest.txt") files below $top"
