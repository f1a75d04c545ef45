# Read by CTest, not by CMake: adds one CTest test for each test of a suite, from
# `rtf list`, after the plug-ins are built. These variables contain the arguments of
# rtf_add_suite:
#
#   rtf_name rtf_cmake rtf_program rtf_suite rtf_environment rtf_directory rtf_configurations
#   rtf_labels rtf_properties (a list of property, value, property, value …)

cmake_policy(PUSH)
cmake_policy(VERSION 3.16...3.25)

if(rtf_configurations AND NOT CTEST_CONFIGURATION_TYPE IN_LIST rtf_configurations)
  cmake_policy(POP)
  return()
endif()

# Adds a test that runs `select`: the suite, or one test of it.
function(_rtf_suite_test name select labels)
  add_test("${name}" "${rtf_cmake}" -E env ${rtf_environment} "${rtf_program}" run "${select}")
  set_tests_properties("${name}" PROPERTIES WORKING_DIRECTORY "${rtf_directory}" ${rtf_properties})
  if(labels)
    set_tests_properties("${name}" PROPERTIES LABELS "${labels}")
  endif()
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

if(_rtf_count EQUAL 0)
  # The suite is invalid: a run reports why. (Or this CTest is too old to read the list.)
  _rtf_suite_test("${rtf_name}" "${rtf_suite}" "${rtf_labels}")
else()
  math(EXPR _rtf_last "${_rtf_count} - 1")
  foreach(_rtf_index RANGE ${_rtf_last})
    string(JSON _rtf_test GET "${_rtf_json}" tests ${_rtf_index} name)
    string(JSON _rtf_select GET "${_rtf_json}" tests ${_rtf_index} select)
    string(JSON _rtf_tags LENGTH "${_rtf_json}" tests ${_rtf_index} tags)
    set(_rtf_all_labels ${rtf_labels})
    while(_rtf_tags GREATER 0)
      math(EXPR _rtf_tags "${_rtf_tags} - 1")
      string(JSON _rtf_tag GET "${_rtf_json}" tests ${_rtf_index} tags ${_rtf_tags})
      list(APPEND _rtf_all_labels "${_rtf_tag}")
    endwhile()
    _rtf_suite_test("${rtf_name}/${_rtf_test}" "${_rtf_select}" "${_rtf_all_labels}")
  endforeach()
endif()

cmake_policy(POP)
