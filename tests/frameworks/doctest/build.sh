# shellcheck shell=bash
# doctest of the system.
need_packages doctest-dev g++
cpp_programs
