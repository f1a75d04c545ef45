#!/bin/sh
# A stand-in for a robot or its simulator: a joint that turns to 90 degrees within half a second.
# It writes its position to a file. rtf stores the directory of the run in RTF_RUN_DIR.
set -eu

state=$RTF_RUN_DIR/my_robot.txt

# The file is replaced at once, so that no test reads half a line.
write() {
  echo "$1" >"$state.new"
  mv "$state.new" "$state"
}

write 0
echo "the position is in $state" # the suite waits for this line
for position in 15 30 45 60 75 90; do
  sleep 0.1
  write "$position"
done
exec sleep infinity # until rtf stops it
