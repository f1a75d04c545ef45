# Runs a suite once for all its CTest tests. They read their results from the run, to
# which the link leads; its name has a part that is new in each run of ctest.
#
#   cmake -Drtf_program=<rtf> -Drtf_suite=<file> -Drtf_codes=<digits> -Drtf_base=<path>
#         -Drtf_link=<path> -Drtf_limit=<words before the command, separated by |>
#         -Drtf_junit=<file, or nothing> -P rtf-suite-run.cmake
#
# It passes with those exit codes of `rtf run`.

cmake_minimum_required(VERSION 3.16...3.25)

# With `ctest --repeat-until-fail`: a later run must not hide that this one was not green.
if(IS_SYMLINK "${rtf_link}")
  execute_process(COMMAND "${rtf_program}" show "${rtf_link}"
    RESULT_VARIABLE _code OUTPUT_QUIET ERROR_QUIET)
  if(_code MATCHES "^[14]$")
    message("not repeated: the run before was not green")
    return()
  endif()
endif()

# The links of earlier runs of ctest.
file(GLOB _links "${rtf_base}.run-*")
list(REMOVE_ITEM _links "${rtf_link}")
if(_links)
  file(REMOVE ${_links})
endif()

set(_report "")
if(rtf_junit)
  get_filename_component(_name "${rtf_junit}" NAME)
  file(WRITE "${rtf_junit}"
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<testsuites tests=\"1\" failures=\"0\" errors=\"1\" skipped=\"0\">\n"
    "  <testsuite name=\"rtf\" tests=\"1\" failures=\"0\" errors=\"1\" skipped=\"0\">\n"
    "    <testcase classname=\"rtf\" name=\"${_name}\">\n"
    "      <error message=\"the run of the suite wrote no report\"/>\n"
    "    </testcase>\n  </testsuite>\n</testsuites>\n")
  set(_report --report "junit=${rtf_junit}")
endif()

string(REPLACE "|" ";" rtf_limit "${rtf_limit}")
execute_process(
  COMMAND ${rtf_limit} "${rtf_program}" run --symlink "${rtf_link}" ${_report} "${rtf_suite}"
  RESULT_VARIABLE _code)
if(NOT _code MATCHES "^[${rtf_codes}]$")
  message(FATAL_ERROR "rtf run ${rtf_suite}: exit code ${_code}")
endif()
