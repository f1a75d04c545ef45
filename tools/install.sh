#!/usr/bin/env bash
# Installs rtf below PREFIX; with DESTDIR, below DESTDIR/PREFIX (for packages).
# tools/uninstall.sh reads the list of installed files from share/rtf/manifest.txt.

. "$(dirname "$0")/env.sh"

PREFIX=${PREFIX:-/usr/local}
DESTDIR=${DESTDIR:-}
case $PREFIX in
  /*) ;;
  *) die "PREFIX is \`$PREFIX\`, which is not an absolute path" ;;
esac
top=$DESTDIR$PREFIX
release=$TARGET/release

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT

# Installs one file: mode, source, destination below the prefix.
put() {
  install -D -m "$1" "$2" "$top/$3"
  printf '%s\n' "$3" >>"$stage/manifest.txt"
}

# Installs a link: target, destination below the prefix.
put_link() {
  ln -sfn "$1" "$top/$2"
  printf '%s\n' "$2" >>"$stage/manifest.txt"
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
if [ -z "${SUDO_USER:-}" ]; then
  tools/bootstrap.sh build
  tools/build.sh
fi
for program in rtf rtf-host-native rtf-host-lua rtf-host-framework; do
  [ -x "$release/$program" ] || die "$release/$program is missing" "run \`make build\` first"
done
if [ -e "$top" ] && [ ! -w "$top" ]; then
  die "$top cannot be written" "sudo make install, or choose another PREFIX"
fi
if [ -e "$top/share/rtf/manifest.txt" ]; then
  tools/uninstall.sh # files of an older version that the new one does not have
fi

"$release/rtf" man "$stage/man"
for shell in bash zsh fish; do
  "$release/rtf" completions "$shell" >"$stage/rtf.$shell"
done

put 755 "$release/rtf" bin/rtf
put_link rtf bin/robottestingframework-testrunner # the command line of 2.x
put 755 "$release/rtf-host-native" libexec/rtf/rtf-host-native
put 755 "$release/rtf-host-lua" libexec/rtf/rtf-host-lua
put 755 "$release/rtf-host-framework" libexec/rtf/rtf-host-framework
if [ -e "$BUILD/librtf-cppunit.so" ]; then
  put 644 "$BUILD/librtf-cppunit.so" libexec/rtf/librtf-cppunit.so
else
  say "note: librtf-cppunit.so was not built: CppUnit programs need rtf/cppunit.hpp in their main function"
fi
put_tree sdk/c/include include '*.h'
put_tree sdk/cpp/include include '*.h' '*.hpp'
put_tree sdk/cpp/cmake lib/cmake '*.cmake'
# The Lua SDK is part of rtf-host-lua.
put_tree sdk/python/rtf share/rtf/python/rtf '*.py' py.typed
put 644 sdk/python/robottestingframework.py share/rtf/python/robottestingframework.py
put_tree sdk/ruby/lib share/rtf/ruby/lib '*.rb'
put_tree sdk/ada/src share/rtf/ada/src '*.ads' '*.adb'
put_tree sdk/ada/aunit share/rtf/ada/aunit '*.ads' '*.adb'
put 644 sdk/ada/robottestingframework.gpr share/rtf/ada/robottestingframework.gpr
put 644 sdk/ada/rtf_aunit.gpr share/rtf/ada/rtf_aunit.gpr
put_tree fixtures share/rtf/fixtures '*.py' '*.json'
put_tree spec share/rtf/spec '*.md' '*.xsd'
put_tree schemas share/rtf/schemas '*.json'
put_tree "$stage/man" share/man/man1 '*.1'
put 644 "$stage/rtf.bash" share/bash-completion/completions/rtf
put 644 "$stage/rtf.zsh" share/zsh/site-functions/_rtf
put 644 "$stage/rtf.fish" share/fish/vendor_completions.d/rtf.fish
for page in README.md CHANGELOG.md LICENSE; do
  put 644 "$page" "share/doc/rtf/$page"
done
put_tree docs share/doc/rtf/docs '*.md'
put_tree examples share/doc/rtf/examples '*.md' '*.xml' '*.py' '*.lua' '*.rb' '*.cpp' '*.hpp' '*.launch' CMakeLists.txt

install -D -m 644 "$stage/manifest.txt" "$top/share/rtf/manifest.txt"
say "installed $(wc -l <"$stage/manifest.txt") files below $top"
