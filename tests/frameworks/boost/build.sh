# shellcheck shell=bash
# Boost.Test of the system, linked dynamically.
need_packages libboost-test-dev g++
cpp_programs -DBOOST_TEST_DYN_LINK -lboost_unit_test_framework
