# shellcheck shell=bash
# shellcheck disable=SC2154 # tests/frameworks/build.sh sets the directories
# CppUnit of the system, and the library that rtf loads into its programs.
need_packages libcppunit-dev g++
quietly tools/preload.sh

# NAME, of a source, options of the compiler. Depends also on the headers of the SDK.
cppunit_program() {
  local program=$out/$1 file=$source/$2
  shift 2
  if [ -e "$program" ] && [ -z "$(find "$file" "$source/build.sh" tests/frameworks/descendants sdk/cpp/include/rtf -newer "$program" -name '*.*')" ]; then
    return 0
  fi
  quietly c++ -std=c++17 -g -O0 -Wall -Wextra -Isdk/cpp/include -o "$program" "$file" "$@" -pthread
}

cppunit_program arm_test arm_test.cpp -lcppunit
cppunit_program broken_test broken_test.cpp -lcppunit
cppunit_program promises_test promises_test.cpp -lcppunit
cppunit_program odd_test odd_test.cpp -lcppunit
cppunit_program header_test header_test.cpp -l:libcppunit.a -ldl
cppunit_program static_test arm_test.cpp -l:libcppunit.a -ldl
cppunit_program shared_header_test header_test.cpp -lcppunit
cppunit_program sanitized_test arm_test.cpp -lcppunit -fsanitize=address
cppunit_program not_cppunit not_cppunit.cpp
cppunit_program descendants_test descendants_test.cpp -lcppunit
cppunit_program descendants_header_test descendants_test.cpp -DREPORTS_CASES -l:libcppunit.a -ldl
install -m 755 "$source/wrapped_test.sh" "$out/wrapped_test"
