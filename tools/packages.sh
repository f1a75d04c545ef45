# shellcheck shell=bash
# Installs Debian packages; to be sourced after env.sh.

# Runs apt-get as root, with sudo if necessary. It prompts for a password only on a terminal.
apt() {
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    have sudo || return 1
    root=(sudo -n)
    [ ! -t 0 ] || sudo -v || return 1
  fi
  quietly "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq \
    -o DPkg::Lock::Timeout=300 "$@"
}

# The version of a package that apt-get would install; empty if it knows none.
candidate_of() {
  local version
  version=$(apt-cache policy "$1" 2>/dev/null | sed -n 's/^ *Candidate: *//p')
  [ "$version" = '(none)' ] || printf '%s' "$version"
}

# Installs packages, or prints how to do so manually. It never removes a package.
install_packages() {
  local by_hand="sudo apt-get install $*"
  have apt-get || die "missing: $* (Debian's names)" \
    "install the equivalent packages of this system, then try again"
  say "installing: $*"
  apt install -y --no-install-recommends --no-remove "$@" ||
    { apt update && apt install -y --no-install-recommends --no-remove "$@"; } ||
    die "missing and could not be installed: $*" "as root: $by_hand"
}

# Installs the packages that dpkg does not list as installed.
need_packages() {
  local package missing=()
  for package in "$@"; do
    [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
}
