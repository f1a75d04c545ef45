# shellcheck shell=bash
# GoogleTest and GoogleMock of the system.
need_packages libgtest-dev libgmock-dev cmake g++
# shellcheck disable=SC2154 # set by the caller
quietly c++ -std=c++17 -g -O0 -Wall -fPIC -shared "$source/library/thread.cpp" -o "$out/libthread.so" -pthread
cpp_programs -L"$out" -Wl,-rpath,"$out" -Wl,--as-needed -lthread -lgtest_main -lgmock -lgtest -pthread
