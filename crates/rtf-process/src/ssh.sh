#!/bin/sh
# What runs on the other machine: SIGNAL GRACE COMMAND…
#
# sshd made this shell the leader of a session and group, in which the command
# is started. Standard input is the life line: after a greeting, each line is a
# signal for the group. Its end means that nobody is there any more: the command
# is asked to stop by SIGNAL, and GRACE seconds later everything is killed.

stop=$1 grace=$2 mark=RTF_REMOTE=$$.$(date +%s)
shift 2
kill -s 0 -- "-$$" || exit 254
exec 3<&0 </dev/null

# Kills all that the command started, also what left the group.
sweep() {
  rounds=5
  while [ "$rounds" -gt 0 ]; do
    rounds=$((rounds - 1))
    # It complains about those that end meanwhile.
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

# They are for the command; the trap keeps this shell alive to tell its end.
trap : HUP INT QUIT PIPE ALRM TERM USR1 USR2
env "$mark" "$@" 3<&-
code=$?
sweep
# ssh itself ends with 255 when the connection is lost.
[ "$code" -ne 255 ] || code=254
exit "$code"
