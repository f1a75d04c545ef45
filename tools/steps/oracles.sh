# shellcheck shell=bash
# Comparisons with results of other programs. tools/test.sh sources this file.

# Change points, compared with those of Apache Otava and with planted changes.
history_change_points() {
  local python
  # Without dependencies: see tools/requirements-history.txt.
  python=$(PIP_NO_DEPS=1 tools/venv.sh history)/python
  cargo build --quiet --locked -p rtf-history --example change_points
  "$python" tests/history/check.py "$TARGET/debug/examples/change_points"
}

# What the unit tests of campaigns compare with: results of SciPy and savvi, and lists of episodes by
# a second implementation.
campaign_oracle() {
  local python
  python=$(PIP_NO_DEPS=1 tools/venv.sh history)/python
  "$python" tests/campaign/oracle.py --check tests/campaign/scipy.json
  "$python" tests/campaign/episodes.py --check crates/rtf-campaign/tests/campaign/golden/*.xml
  python=$(tools/venv.sh sequential)/python
  "$python" tests/campaign/sequential.py tests/campaign/scipy.json
}

# Robustness of random formulas, compared with rtamt and with a second implementation.
monitor_oracle() {
  local python
  python=$(PIP_NO_DEPS=1 tools/venv.sh monitor)/python
  cargo build --quiet --locked -p rtf-monitor --example robustness
  "$python" tests/monitor/oracle.py "$TARGET/debug/examples/robustness"
}

# Limits of robot models, compared with those of MuJoCo.
envelope_oracle() {
  "$(tools/venv.sh icub)/python" tests/envelopes/oracle.py "$TARGET/debug/rtf"
}

# Distances of dynamic time warping, compared with those of dtaidistance, and differences of
# pictures, compared with those of scikit-image.
golden_oracle() {
  local python
  python=$(tools/venv.sh golden)/python
  cargo build --quiet --locked -p rtf-golden --examples
  "$python" tests/golden/oracle.py "$TARGET/debug/examples/warp"
  "$python" tests/golden/pictures.py "$TARGET/debug/examples/similarity"
}

# Parquet files of the history, read by Apache Arrow.
history_export() {
  "$(tools/venv.sh export)/python" tests/history/export.py "$TARGET/debug/rtf"
}
