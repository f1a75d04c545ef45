#!/usr/bin/env bash
# Prints a directory with the control plane of Kubernetes and `kubectl`, which it builds if necessary: one program with a
# name for each component. It is in the user's cache, because building it takes minutes; its name has a hash of its
# sources, which contain the versions of its modules.

. "$(dirname "$0")/../../../tools/env.sh"

PATH=$(tools/go.sh):$PATH
cd tests/executors/control_plane
key=$({ go version && cat go.mod go.sum main.go; } | sha256sum | cut -c1-12)
dir=$CACHE/kubernetes-$key
version=$(sed -n 's/^\tk8s.io\/kubernetes //p' go.mod)

# Only one process at a time may build it.
mkdir -p "$CACHE"
exec 9>"$dir.lock"
flock 9

if [ ! -e "$dir/complete" ]; then
  say "building Kubernetes $version in $dir"
  rm -rf "$dir"
  mkdir -p "$dir"
  # Release builds of Kubernetes set the version like this.
  flags="-s -w"
  for package in k8s.io/component-base/version k8s.io/client-go/pkg/version; do
    flags+=" -X $package.gitVersion=$version"
  done
  CGO_ENABLED=0 GOTOOLCHAIN=local quietly nice go build -trimpath -ldflags "$flags" -o "$dir/kubernetes" . ||
    die "Kubernetes could not be built"
  for component in etcd kube-apiserver kube-controller-manager kube-scheduler kubectl; do
    ln -s kubernetes "$dir/$component"
  done
  touch "$dir/complete"
fi
printf '%s\n' "$dir"
