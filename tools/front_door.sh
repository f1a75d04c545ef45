#!/usr/bin/env bash
# Tests the first steps of a new user in a temporary chroot with only Debian's base system,
# make, git and ca-certificates. It uses the machine's apt-get, npm and pip settings.
#
#   tools/front_door.sh           the bootstrap: an old Rust stays, Debian's is used
#   tools/front_door.sh demo      make demo, from a fresh checkout (includes a release build)
#
# It needs root, or sudo without a password. The base system is kept in the user's cache.

. "$(dirname "$0")/env.sh"
. tools/packages.sh

goal=${1:-packages}

if [ "$(id -u)" -ne 0 ]; then
  exec sudo -n --preserve-env "$0" "$@"
fi
have mmdebstrap || install_packages mmdebstrap

# The sources of Debian's packages, as lines of sources.list.
# shellcheck disable=SC2016 # apt-get fills that in
sources=$(apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
  'Created-By: Packages' | sed -n 's/^Debian //p' | sort -u)
[ -n "$sources" ] || die "apt-get has no lists of Debian's packages" "sudo apt-get update; not tested on Ubuntu"
settings=$(apt-config dump Acquire | grep '::.*::' || true)
release=$(. /etc/os-release && printf '%s' "$VERSION_CODENAME")

key=$(printf '%s\n' "$release" "$sources" "$settings" | sha256sum | cut -c1-12)
base=$CACHE/debian-$release-$key
mkdir -p "$base/archives"
exec 9>"$base/lock"
flock 9

if [ ! -e "$base/root.tar" ]; then
  say "creating a base of Debian $release in $base"
  printf '%s\n' "$settings" >"$base/apt.conf"
  quietly mmdebstrap --format=tar --variant=minbase --include=ca-certificates,make,git --aptopt="$base/apt.conf" \
    "$release" "$base/root.tar.new" <<<"$sources" || die "mmdebstrap could not create it"
  mv "$base/root.tar.new" "$base/root.tar"
fi

work=$(mktemp -d)
debian=$work/debian
# The mounts disappear with the session's namespace.
trap 'rm -rf --one-file-system "$work"' EXIT
mkdir "$debian"
tar -xf "$base/root.tar" -C "$debian" --exclude './dev/*'
cp -L /etc/resolv.conf /etc/hosts "$debian/etc/"
cp -L /etc/ssl/certs/ca-certificates.crt "$debian/etc/ssl/certs/"
for file in /etc/pip.conf "$HOME/.config/pip/pip.conf" "$HOME/.npmrc" "$HOME/.cargo/config.toml"; do
  [ ! -e "$file" ] || install -D -m 600 "$file" "$debian${file/#"$HOME"/\/root}"
done
mkdir "$debian/checkout"
git ls-files -z --cached --others --exclude-standard | tar -c --null --files-from=- | tar -x -C "$debian/checkout"
# An old Rust, as on a machine of a user who installed it long ago.
mkdir -p "$debian/old/bin"
for tool in cargo rustc; do
  printf '#!/bin/sh\necho "%s 1.63.0 (old)"\n' "$tool" >"$debian/old/bin/$tool"
  chmod +x "$debian/old/bin/$tool"
done

case $goal in
  packages) cat >"$debian/session.sh" ;;
  demo) cat >/dev/null && printf 'set -eux\nmake demo\n' >"$debian/session.sh" ;;
  *) die "no goal \`$goal\`: packages or demo" ;;
esac <<'SESSION'
set -eux
[ -z "$(command -v cc cargo python3 cmake)" ]

# If no package is new enough, bootstrap prints one error and installs nothing.
sed -i.bak 's/^rust-version = .*/rust-version = "99.0"/' Cargo.toml
dpkg --list >../before
! PATH=/old/bin:$PATH tools/bootstrap.sh demo 2>../messages || exit 1
dpkg --list | cmp - ../before
cat ../messages
grep -x 'error: cargo 99.0 or later is missing, this is 1.63.0' ../messages
grep -x 'hint: this system has no package of it: .*rustup.rs.*' ../messages
mv Cargo.toml.bak Cargo.toml

# Debian's Rust is installed next to the old one and takes precedence.
PATH=/old/bin:$PATH tools/bootstrap.sh demo
/old/bin/cargo --version | grep -F 1.63.0
for path in "$PATH" "/old/bin:$PATH"; do
  PATH=$path bash -c '. tools/env.sh; has_new_rust; cargo --version; rustc --print sysroot'
done
# A second bootstrap finds everything and prints nothing.
[ -z "$(tools/bootstrap.sh demo 2>&1)" ]
[ -z "$(tools/bootstrap.sh build 2>&1)" ]
# The installed packages can compile, link, and create a virtual environment.
printf 'fn main() {}\n' >/tmp/a.rs && bash -c '. tools/env.sh; rustc -o /tmp/a /tmp/a.rs' && /tmp/a
python3 -m venv /tmp/venv && /tmp/venv/bin/pip --version
SESSION

# This session's variables that package managers read.
environment=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8)
while IFS= read -r name; do
  environment+=("$name=${!name}")
done < <(compgen -e | grep -E -i '^(.*_proxy|pip_.*|npm_config_.*|cargo_http_.*|cargo_registr.*|ssl_cert_.*|node_extra_ca_certs)$' || true)

export debian base
started=$SECONDS
# shellcheck disable=SC2016 # the shell in the namespace expands that
unshare --mount --propagation private bash -euc '
  mount --bind "$debian" "$debian"
  mount --rbind /dev "$debian/dev"
  mount -t proc proc "$debian/proc"
  mount --rbind /sys "$debian/sys"
  mount -t tmpfs tmpfs "$debian/run"
  mkdir -p "$debian/var/cache/apt/archives"
  mount --bind "$base/archives" "$debian/var/cache/apt/archives"
  exec chroot "$debian" env -i "$@" sh -c "cd /checkout && exec bash /session.sh"
' - "${environment[@]}" </dev/null
say "$goal: $((SECONDS - started)) s"
