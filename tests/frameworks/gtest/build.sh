# shellcheck shell=bash
# GoogleTest and GoogleMock of the system.
need_packages libgtest-dev libgmock-dev cmake g++
cpp_programs -lgmock -lgtest -pthread
