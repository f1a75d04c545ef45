# shellcheck shell=bash
# Sessions in a temporary root directory with only Debian's base system, make, git and
# ca-certificates. They use the machine's settings of apt-get, npm, pip, cargo, Go and Maven. To
# be sourced after env.sh and packages.sh; needs root.
#
# The base system and downloaded packages are kept in the user's cache, for each release and
# set of sources. Sessions for arm64 run under qemu's user emulation, see tools/binfmt.sh.

# Restarts the script with sudo, if it is not run by root.
become_root() {
  [ "$(id -u)" -eq 0 ] || exec sudo -n --preserve-env "$0" "$@"
}

# The architecture of the base, unless it is the machine's, and what runs its programs.
architecture=
emulation=()

# The following sessions are in a Debian for arm64.
use_arm64() {
  need_packages arch-test
  architecture=arm64
  emulation=("$ROOT/tools/binfmt.sh" aarch64)
}

# Sets `base`, the directory with root.tar and apt-get's archives; creates it if necessary.
# Other sessions wait until the script ends or calls release_base, because sessions write into
# the archives.
need_base() {
  local sources settings release key options=()
  have mmdebstrap || install_packages mmdebstrap
  [ -z "$architecture" ] || options=("--architectures=$architecture" --mode=root)
  # The sources of Debian's packages, as lines of sources.list.
  # shellcheck disable=SC2016 # apt-get fills that in
  sources=$(apt-get indextargets --format '$(ORIGIN) deb $(REPO_URI) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' | sed -n 's/^Debian //p' | sort -u)
  [ -n "$sources" ] || die "apt-get has no lists of Debian's packages" "sudo apt-get update; not tested on Ubuntu"
  settings=$(apt-config dump Acquire | grep '::.*::' || true)
  release=$(. /etc/os-release && printf '%s' "$VERSION_CODENAME")

  key=$(printf '%s\n' "$release" "$sources" "$settings" | sha256sum | cut -c1-12)
  base=$CACHE/debian-$release${architecture:+-$architecture}-$key
  mkdir -p "$base/archives"
  exec 8>"$base/lock"
  flock 8
  # Newer packages replace those of an old base slowly.
  [ -z "$(find "$base" -maxdepth 1 -name root.tar -mtime +30)" ] || rm "$base/root.tar"
  [ ! -e "$base/root.tar" ] || return 0
  say "creating a base of Debian $release${architecture:+ for $architecture} in $base"
  printf '%s\n' "$settings" >"$base/apt.conf"
  printf '%s\n' "$sources" >"$base/sources.list"
  quietly "${emulation[@]}" mmdebstrap "${options[@]}" --format=tar --variant=minbase --aptopt="$base/apt.conf" \
    --include=ca-certificates,make,git "$release" "$base/root.tar.new" "$base/sources.list" ||
    die "mmdebstrap could not create it"
  mv "$base/root.tar.new" "$base/root.tar"
}

# Later sessions of this script download packages into their own directory.
release_base() {
  flock --unlock 8
  base=
}

# Unpacks the base into a directory, with the machine's settings and certificates.
unpack_base() {
  local debian=$1 file
  mkdir -p "$debian"
  tar -xf "$base/root.tar" -C "$debian" --exclude './dev/*'
  echo force-unsafe-io >"$debian/etc/dpkg/dpkg.cfg.d/temporary" # no fsync
  sed -i '/DEP-11/d' "$debian/etc/apt/apt.conf.d/99mmdebstrap"  # lists for graphical programs
  cp -L /etc/resolv.conf /etc/hosts "$debian/etc/"
  add_certificates "$debian"
  for file in /etc/pip.conf "$HOME"/{.config/pip/pip.conf,.npmrc,.cargo/config.toml,.config/go/env,.m2/settings.xml}; do
    [ ! -e "$file" ] || install -D -m 600 "$file" "$debian${file/#"$HOME"/\/root}"
  done
}

# Most programs read one file with all certificates. Packages such as Java's create their own from
# the links that update-ca-certificates sets.
add_certificates() {
  local debian=$1 file
  cp -L /etc/ssl/certs/ca-certificates.crt "$debian/etc/ssl/certs/"
  while IFS= read -r file; do
    install -D -m 644 "$file" "$debian$file"
    ln -s "$file" "$debian/etc/ssl/certs/$(basename "$file" .crt).pem"
  done < <(find -L /usr/local/share/ca-certificates -type f -name '*.crt')
}

# Runs a bash script of the unpacked base in a directory there, with the machine's network or with
# only a loopback interface: base, network|loopback, directory, script.
run_in_base() {
  local environment=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8) name
  local namespaces=(--mount --propagation private --pid --fork --kill-child) settings=''
  # This session's variables that package managers read.
  while IFS= read -r name; do
    environment+=("$name=${!name}")
  done < <(compgen -e | grep -E -i '^(.*_proxy|pip_.*|npm_config_.*|cargo_http_.*|cargo_registr.*|go(proxy|sumdb|private|noproxy|nosumdb|flags|toolchain)|maven_(opts|args)|ssl_cert_.*|node_extra_ca_certs)$' || true)
  if [ "$2" = loopback ]; then
    namespaces+=(--net)
    settings='ip link set lo up;'
  fi
  # The mounts and all processes disappear with the namespaces, also if this script is killed. In a
  # chroot, the kernel refuses user namespaces, so the root of the namespace is changed.
  # shellcheck disable=SC2016 # the shell in the namespace expands that
  debian=$1 base=$base directory=$3 script=$4 "${emulation[@]}" unshare "${namespaces[@]}" bash -euc "$settings"'
    mount --bind "$debian" "$debian"
    mount --rbind /dev "$debian/dev"
    mount -t proc proc "$debian/proc"
    mount --rbind /sys "$debian/sys"
    mount -t tmpfs tmpfs "$debian/run"
    if [ -n "$base" ]; then
      mkdir -p "$debian/var/cache/apt/archives"
      mount --bind "$base/archives" "$debian/var/cache/apt/archives"
    fi
    cd "$debian"
    pivot_root . mnt
    hash -r
    umount --lazy /mnt
    cd "$directory"
    exec /usr/bin/env -i "$@" bash "$script"
  ' - "${environment[@]}" </dev/null
}
