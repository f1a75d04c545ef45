#!/bin/sh
# Runs a command on the remote machine: SIGNAL GRACE COMMAND…
#
# sshd made this shell the leader of a session and group, in which the command
# runs. Standard input is the channel of the runner: after a greeting, each line
# is a signal for the group. At its end the runner is gone: the script sends
# SIGNAL, and kills everything GRACE seconds later.

stop=$1 grace=$2 mark=RTF_REMOTE=$$.$(date +%s)
shift 2
kill -s 0 -- "-$$" || exit 254
exec 3<&0 </dev/null

# Kills everything that the command started, including processes that left the group.
sweep() {
  rounds=5
  while [ "$rounds" -gt 0 ]; do
    rounds=$((rounds - 1))
    # grep complains about processes that have ended.
    found=$(grep -l -s -F -e "$mark" /proc/[0-9]*/environ)
    [ -n "$found" ] || return
    for file in $found; do
      file=${file#/proc/}
      kill -s KILL "${file%/environ}"
    done
  done 2>/dev/null
}

(
  trap '' HUP INT QUIT PIPE ALRM TERM USR1 USR2
  exec >/dev/null 2>&1
  read -r signal <&3
  while read -r signal <&3; do
    [ "$signal" != KILL ] || sweep
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
trap : HUP INT QUIT PIPE ALRM TERM USR1 USR2
env "$mark" "$@" 3<&-
code=$?
sweep
# ssh exits with 255 when the connection is lost.
[ "$code" -ne 255 ] || code=254
exit "$code"
