# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# AUnit of the system, with GNAT's compiler.
need_packages libaunit22-dev gnat gprbuild g++
quietly c++ -std=c++17 -c -o "$out/deeds.o" tests/frameworks/descendants/deeds.cpp
GPR_PROJECT_PATH=$ROOT/sdk/ada quietly gprbuild -p -q -P "$source/tests.gpr" "-XBUILD=$out"
quietly c++ -o "$out/not_aunit" "$source/not_aunit.cpp"
