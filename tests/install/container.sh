#!/usr/bin/env bash
# Builds packaging/container/Containerfile with Debian's buildah, and runs suites in the image:
#
#   tests/install/container.sh PACKAGES DEBIAN
#
# PACKAGES is the directory of the Debian packages, DEBIAN the root directory of a minimal Debian, which is the base image:
# no registry is needed. `chroot` replaces the container engine, and the network is the machine's. Needs root.

. "$(dirname "$0")/../../tools/env.sh"
. tools/packages.sh

packages=$1
debian=$2
need_packages buildah
work=$(mktemp -d)
# Everything that buildah stores.
export BUILDAH_ISOLATION=chroot
run_buildah() { buildah --root "$work/storage" --runroot "$work/run" --storage-driver vfs "$@"; }
cleanup() {
  # buildah does not name a full disk: it says "write on closed pipe".
  [ $? -eq 0 ] || df -h "$work"
  run_buildah rm --all >/dev/null 2>&1 || true
  rm -rf --one-file-system "$work"
}
trap cleanup EXIT

base=$(run_buildah from scratch)
run_buildah add --quiet "$base" "$debian" / >/dev/null
run_buildah commit --quiet "$base" localhost/debian >/dev/null
run_buildah rm "$base" >/dev/null

mkdir -p "$work/context/suites"
cp "$packages"/rtf_*.deb "$work/context"
cp tests/install/downstream/interpreted.xml tests/install/downstream/*.{lua,py} "$work/context/suites"
run_buildah build --quiet --file packaging/container/Containerfile --build-arg BASE=localhost/debian \
  --build-arg DIRECTORY=/home/me/suites --tag localhost/robot-tests "$work/context"

container=$(run_buildah from --pull-never localhost/robot-tests)
# As the script of a task calls it: in the image's working directory, with `rtf` from PATH, and results in a volume.
mkdir "$work/results"
# shellcheck disable=SC2016 # the shell in the container expands that
run_buildah run --volume "$work/results:/home/me/suites/rtf-results" "$container" -- \
  /bin/sh -c '[ "$PWD" = /home/me/suites ] && exec rtf run --no-history interpreted.xml'
[ -e "$work/results/latest/events.jsonl" ] || die "the results are not in the volume"
