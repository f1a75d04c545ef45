#!/usr/bin/env bats
# bats: comments after failed tests.

@test "passes" {
  true
}

@test "fails" {
  echo "about to fail"
  [ 1 -eq 2 ] # line: bats
}

@test "skips" {
  skip "no gripper"
}

@test 'quotes "a", [b] and # c' {
  run echo hello
  [ "$output" = hello ]
}
