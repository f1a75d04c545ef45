#!/bin/sh
# Ends in all ways: `exits.sh MODE`.
echo "on stdout"
case $1 in
  pass) echo "a warning" >&2 ;;
  fail) printf 'first\njoint 3 does not move\n\n' >&2 && exit 3 ;;
  silent) exit 1 ;;
  skip) echo "no gripper, <none>" >&2 && exit 77 ;;
  missing) no_such_program ;;
  not-executable) exec "$0.txt" ;;
  crash) kill -SEGV $$ ;;
  hang) sleep 1000 ;;
  environment) [ "$ARM_MODE" = careful ] && [ "$2" = "two words" ] && [ "$3" = "" ] ;;
esac
