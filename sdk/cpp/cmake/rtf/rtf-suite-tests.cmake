# Read by CTest, not by CMake: adds the CTest tests of a suite, from `rtf list`, after the
# plug-ins are built. These variables contain the arguments of rtf_add_suite:
#
#   rtf_name rtf_cmake rtf_program rtf_suite rtf_environment rtf_directory rtf_configurations
#   rtf_labels rtf_properties (a list of property, value, property, value …)
#   rtf_limit (the words that limit the time of a command) rtf_junit rtf_separate_runs
#   rtf_base (the path of the suite's files in the binary directory, without extension)

cmake_policy(PUSH)
cmake_policy(VERSION 3.16...3.25)

if(rtf_configurations AND NOT CTEST_CONFIGURATION_TYPE IN_LIST rtf_configurations)
  cmake_policy(POP)
  return()
endif()

# Adds a test: name, labels, command.
function(_rtf_ctest_test name labels)
  add_test("${name}" "${rtf_cmake}" -E env ${rtf_environment} ${ARGN})
  set_tests_properties("${name}" PROPERTIES WORKING_DIRECTORY "${rtf_directory}")
  if(labels)
    set_tests_properties("${name}" PROPERTIES LABELS "${labels}")
  endif()
endfunction()

# Adds a test that is a separate run of one test of the suite.
function(_rtf_separate_test test select labels)
  set(name "${rtf_name}/${test}")
  _rtf_ctest_test("${name}" "${labels}" ${rtf_limit} "${rtf_program}" run "${select}")
  if(rtf_properties)
    set_tests_properties("${name}" PROPERTIES ${rtf_properties})
  endif()
endfunction()

# Adds a test that runs the suite. It passes with the exit codes `codes` of rtf.
function(_rtf_run_test codes)
  # CMake splits arguments at semicolons.
  string(REPLACE ";" "|" limit "${rtf_limit}")
  _rtf_ctest_test("${rtf_name}" "${rtf_labels}" "${rtf_cmake}"
    "-Drtf_program=${rtf_program}" "-Drtf_suite=${rtf_suite}" "-Drtf_codes=${codes}"
    "-Drtf_limit=${limit}" "-Drtf_base=${rtf_base}" "-Drtf_link=${_rtf_link}"
    "-Drtf_junit=${rtf_junit}" -P "${_rtf_scripts}/rtf-suite-run.cmake")
  if(rtf_properties)
    set_tests_properties("${rtf_name}" PROPERTIES ${rtf_properties})
  endif()
endfunction()

# Adds a test that has the result of the fixtures and hooks, after all others.
function(_rtf_rest_test)
  _rtf_ctest_test("${rtf_name}:suite" "${rtf_labels}"
    "${rtf_program}" show --without-tests "${_rtf_link}")
  set_tests_properties("${rtf_name}:suite" PROPERTIES FIXTURES_CLEANUP "${rtf_base}")
endfunction()

# Adds a test that has the result of a test of the suite.
function(_rtf_result_test suite test labels)
  set(name "${rtf_name}/${test}")
  _rtf_ctest_test("${name}" "${labels}"
    "${rtf_program}" show "--single-test=${suite}/${test}" "${_rtf_link}")
  set_tests_properties("${name}" PROPERTIES FIXTURES_REQUIRED "${rtf_base}" SKIP_RETURN_CODE 77)
endfunction()

execute_process(
  COMMAND "${rtf_cmake}" -E env ${rtf_environment}
          "${rtf_program}" list --format json "${rtf_suite}"
  WORKING_DIRECTORY "${rtf_directory}"
  RESULT_VARIABLE _rtf_code
  OUTPUT_VARIABLE _rtf_json
  ERROR_QUIET)
set(_rtf_count 0)
if(_rtf_code EQUAL 0 AND NOT CMAKE_VERSION VERSION_LESS 3.19)
  string(JSON _rtf_count LENGTH "${_rtf_json}" tests)
endif()

set(_rtf_scripts "${CMAKE_CURRENT_LIST_DIR}")
# Each run of ctest has another link, so that no test reads the result of an earlier one.
string(RANDOM LENGTH 16 _rtf_link)
set(_rtf_link "${rtf_base}.run-${_rtf_link}")

if(_rtf_count EQUAL 0)
  # The suite is invalid: a run reports why. (Or this CTest is too old to read the list.)
  _rtf_run_test(0)
else()
  if(NOT rtf_separate_runs)
    # 1: a test did not pass. 4: a hook failed. Other tests of CTest are red then.
    _rtf_run_test(014)
    set_tests_properties("${rtf_name}" PROPERTIES FIXTURES_SETUP "${rtf_base}")
    _rtf_rest_test()
  endif()
  math(EXPR _rtf_last "${_rtf_count} - 1")
  foreach(_rtf_index RANGE ${_rtf_last})
    string(JSON _rtf_test GET "${_rtf_json}" tests ${_rtf_index} name)
    string(JSON _rtf_tags LENGTH "${_rtf_json}" tests ${_rtf_index} tags)
    set(_rtf_all_labels ${rtf_labels})
    while(_rtf_tags GREATER 0)
      math(EXPR _rtf_tags "${_rtf_tags} - 1")
      string(JSON _rtf_tag GET "${_rtf_json}" tests ${_rtf_index} tags ${_rtf_tags})
      list(APPEND _rtf_all_labels "${_rtf_tag}")
    endwhile()
    if(rtf_separate_runs)
      string(JSON _rtf_select GET "${_rtf_json}" tests ${_rtf_index} select)
      _rtf_separate_test("${_rtf_test}" "${_rtf_select}" "${_rtf_all_labels}")
    else()
      string(JSON _rtf_suite_name GET "${_rtf_json}" tests ${_rtf_index} suite)
      _rtf_result_test("${_rtf_suite_name}" "${_rtf_test}" "${_rtf_all_labels}")
    endif()
  endforeach()
endif()

cmake_policy(POP)
