#!/usr/bin/env bash
# Installs the missing requirements of a goal.
#
#   tools/bootstrap.sh build|demo|test|docs
#   tools/bootstrap.sh update             updates apt-get's package lists
#
# Programs and libraries come from Debian or Ubuntu; on other systems the script lists
# what is missing. Rust is installed if it is missing or older than Cargo.toml requires;
# tools/env.sh then uses the system's. Python packages go into a virtual environment in
# the user's cache, see tools/venv.sh.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

goal=${1:?goal: build, demo, test, docs or update}

# The Debian packages of each goal.
case $goal in
  build) packages=(gcc) ;;
  demo) packages=(cmake g++ lua-socket python3-venv) ;;
  test) packages=(cmake g++ lua-socket python3-venv libxml2-utils gdb shellcheck clang-format
    procps perl jq curl valgrind stress-ng bindfs ruby ruby-minitest rubocop gnat gprbuild libcppunit-dev openssh-client openssh-server
    chromium fonts-dejavu-core) ;;
  docs) packages=(python3-venv doxygen yard lua-ldoc) ;;
  update) packages=() ;;
  *) die "no goal \`$goal\`: build, demo, test, docs or update" ;;
esac

# Checks for the programs, not for dpkg's packages: Python and the compiler may come from
# another source.
is_present() {
  case $1 in
    gcc) have cc ;;
    g++) have c++ ;;
    rustfmt*) cargo fmt --version >/dev/null 2>&1 ;;
    rust-*clippy) cargo clippy --version >/dev/null 2>&1 ;;
    gnat) have gnatmake ;;
    libcppunit-dev) echo '#include <cppunit/TestResult.h>' | c++ -fsyntax-only -x c++ - 2>/dev/null ;;
    libxml2-utils) have xmllint ;;
    lua-ldoc) have ldoc ;;
    procps) have pgrep ;;
    perl) have prove ;;
    ruby-minitest) have ruby && ruby -e 'require "minitest"' 2>/dev/null ;;
    chromium) have chromium || have chromium-browser ;;
    fonts-dejavu-core) compgen -G '/usr/share/fonts/truetype/*/*.ttf' >/dev/null ;;
    openssh-client) have ssh && have ssh-keygen ;;
    openssh-server) [ -x /usr/sbin/sshd ] ;;
    python3-venv) python3 -c 'import ensurepip, venv' 2>/dev/null ;;
    lua-socket) compgen -G '/usr/lib/*/lua/5.4/socket/core.so' >/dev/null ||
      [ -e /usr/lib/lua/5.4/socket/core.so ] || [ -e /usr/local/lib/lua/5.4/socket/core.so ] ;;
    *) have "$1" ;;
  esac
}

find_missing() {
  missing=()
  for package in "${packages[@]}"; do
    is_present "$package" || missing+=("$package")
  done
}

if [ "$goal" = update ]; then
  apt update || die "apt-get update failed" "as root: apt-get update"
  exit
fi

# Tests start a separate sshd on loopback. The package would start one that listens on the
# network, so it is masked first.
keep_sshd_stopped() {
  local root=()
  [[ " ${missing[*]} " == *" openssh-server "* && -d /run/systemd/system ]] || return 0
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  quietly "${root[@]}" systemctl mask ssh.service ssh.socket ||
    die "openssh-server would start a server that listens on the network" \
      "install it manually, or mask it: sudo systemctl mask ssh.service ssh.socket"
  say "openssh-server is masked and will not start; to undo: sudo systemctl unmask ssh.service ssh.socket"
}

# Sets `suffix` for Debian's newest Rust: rustc, or rustc-web, which stable releases update.
find_rust() {
  for suffix in '' -web; do
    ! is_new_rust "$(candidate_of "rustc$suffix")" || return 0
  done
  return 1
}

no_rust() {
  local installed
  installed=$(rust_version_of cargo)
  die "cargo $RUST_VERSION or later is missing${installed:+, this is $installed}" \
    "this system has no package of it: install it from https://rustup.rs, then try again"
}

need_rust() {
  ! use_rust || return 0
  have apt-get || no_rust
  # The package lists may be outdated or missing.
  find_rust || { apt update && find_rust; } || no_rust
  install_packages "rustc$suffix" "cargo$suffix"
  use_rust || no_rust
}

# rustfmt and clippy come from the same source as Rust.
need_rust_checkers() {
  if [ "$(readlink -f "$(command -v cargo)")" = /usr/bin/cargo ] && find_rust; then
    packages+=("rustfmt$suffix" "rust$suffix-clippy")
  elif ! is_present rustfmt || ! is_present rust-clippy; then
    die "cargo fmt or cargo clippy is missing" "rustup component add rustfmt clippy"
  fi
}

suffix=
need_rust
[ "$goal" != test ] || need_rust_checkers

find_missing
if [ ${#missing[@]} -gt 0 ]; then
  keep_sshd_stopped
  install_packages "${missing[@]}"
  find_missing
  use_rust # rustfmt and clippy may be new
  [ ${#missing[@]} -eq 0 ] || die "still missing after apt-get install: ${missing[*]}"
fi
