# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# AUnit of the system, with GNAT's compiler.
need_packages libaunit22-dev gnat gprbuild g++
GPR_PROJECT_PATH=$ROOT/sdk/ada quietly gprbuild -p -q -P "$source/tests.gpr" "-XBUILD=$out"
quietly c++ -o "$out/not_aunit" "$source/not_aunit.cpp"
