# shellcheck shell=sh
# A fixture that records its tear-down in fixture.log, once there is no file `hold`.
tear_down() {
  while [ -e hold ]; do
    sleep 0.05
  done
  echo "fixture arm is stopped" >>fixture.log
  exit 0
}
trap tear_down TERM
echo ready
while :; do
  sleep 0.05
done
