#!/bin/sh
# Runs a command on the remote machine: SIGNAL GRACE COMMAND…
#
# sshd made this shell the leader of a session and group, in which the command
# runs. Standard input is the channel of the runner: after a greeting, each line
# is a signal for the group, or with the word tree for processes that left it. At
# its end the runner is gone: the script sends SIGNAL, and kills everything GRACE
# seconds later. When the command has ended after a signal, the script waits for
# the processes that it started.

stop=$1 grace=$2 asked='' mark=RTF_REMOTE=$$.$(date +%s)
shift 2
kill -s 0 -- "-$$" || exit 254
exec 3<&0 </dev/null

# Lists everything that the command started, including processes that left the group.
started() {
  # grep complains about processes that have ended.
  grep -l -s -F -e "$mark" /proc/[0-9]*/environ | cut -d / -f 3
}

# Sends a signal to processes that left the group.
ask_others() {
  for pid in $(started); do
    group=$(sed 's/.*) //' "/proc/$pid/stat" | cut -d ' ' -f 3)
    [ "$group" = "$$" ] || kill -s "$1" "$pid"
  done 2>/dev/null
}

# Kills everything that the command started.
sweep() {
  rounds=5
  while [ "$rounds" -gt 0 ]; do
    rounds=$((rounds - 1))
    found=$(started)
    [ -n "$found" ] || return
    for pid in $found; do
      kill -s KILL "$pid"
    done
  done 2>/dev/null
}

(
  trap '' HUP INT QUIT PIPE ALRM TERM USR1 USR2
  exec >/dev/null 2>&1
  read -r signal <&3
  while read -r signal reach <&3; do
    case "$signal $reach" in
    KILL*) sweep ;;
    *tree)
      ask_others "$signal"
      continue
      ;;
    esac
    kill -s "$signal" -- "-$$"
  done
  kill -s "$stop" -- "-$$"
  while [ "$grace" -gt 0 ] && kill -s 0 "$$"; do
    sleep 1
    grace=$((grace - 1))
  done
  sweep
  kill -s KILL -- "-$$"
) &

# Signals are for the command; this shell remains to report its exit code.
trap 'asked=yes' HUP INT QUIT PIPE ALRM TERM USR1 USR2
env "$mark" "$@" 3<&-
code=$?
if [ -n "$asked" ]; then
  ask_others "$stop"
  # The runner, or without it the script above, ends the wait.
  while [ -n "$(started)" ]; do
    sleep 0.1 || sleep 1
  done 2>/dev/null
fi
sweep
# ssh exits with 255 when the connection is lost.
[ "$code" -ne 255 ] || code=254
exit "$code"
