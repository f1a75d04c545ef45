# shellcheck shell=bash
# Tests with servers and clusters, which they start. tools/test.sh sources this file.

# Metrics and traces, read by Prometheus and by OpenTelemetry's collector and its decoder.
telemetry() {
  local prometheus collector decoder=$BUILD/telemetry/telemetry
  prometheus=$(tools/prometheus.sh)
  collector=$(tests/telemetry/collector/build.sh)
  mkdir -p "$BUILD/telemetry"
  PATH=$(tools/go.sh):$PATH
  (cd tests/telemetry && GOTOOLCHAIN=local quietly go build -o "$decoder" .)
  "$(tools/venv.sh telemetry)/python" tests/telemetry/check.py "$TARGET/debug/rtf" "$decoder" \
    "$prometheus" "$collector"
}

# The history in a PostgreSQL server, which the test starts and ends.
history_postgres() {
  local bin
  # shellcheck source=tools/packages.sh
  . tools/packages.sh
  need_packages postgresql
  bin=$(printf '%s\n' /usr/lib/postgresql/*/bin | sort -V | tail -n 1)
  RTF_POSTGRES_BIN=$bin cargo test --quiet --locked -p rtf-history --test postgres -- --ignored
}

# `--executor slurm` with a real cluster, which needs root.
executor_slurm() {
  tools/slurm.sh python3 tests/executors/check_slurm.py "$TARGET/debug/rtf"
}

# `--executor kubernetes` with a real control plane, and nodes that need root.
executor_kubernetes() {
  local programs
  programs=$(tests/executors/control_plane/build.sh)
  unshare --mount --pid --fork --mount-proc --kill-child \
    python3 tests/executors/check_kubernetes.py "$TARGET/release/rtf" "$programs"
}

# What is submitted to Kubernetes, against its schemas.
kubernetes_manifests() {
  local programs
  programs=$(tests/executors/control_plane/build.sh)
  "$(tools/venv.sh kubernetes)/python" tests/executors/manifests.py "$TARGET/release/rtf" "$programs"
}
