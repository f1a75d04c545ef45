# rtf_add_plugin(<target> SOURCES <file>… [HEADERS …] [LIBRARIES …] [OUTPUT_NAME <name>])
#
# Adds a plug-in, a module without the prefix `lib`.
#
# rtf_add_suite(<suite.xml> [NAME <name>] [PLUGINS <target>…] [PLUGIN_PATH <directory>…]
#               [JUNIT <file>] [SEPARATE_RUNS] <common>…)
#
# Adds the CTest tests of a suite; CTest finds them when it starts.
#
#   <name>         runs the suite, and passes if its results are complete
#   <name>/<test>  has the result of one test, and the test's tags as labels
#   <name>:suite   has the result of the fixtures, the hooks and the run itself
#
# The first one sets up a CTest fixture that the others require, so that CTest adds it to
# every selection. For an invalid suite, for example with a missing plug-in, there is only
# <name>, which fails with the reason. With CMake before 3.19 there is only <name>, with the
# result of all tests.
#
# The default NAME is the file's name without its extension. The plug-in path contains the
# directories in which the PLUGINS are built, and those of PLUGIN_PATH; without either, those
# of all plug-ins that the project has added before. JUNIT is a report of each run. Options of
# CTest such as RESOURCE_LOCK and TIMEOUT apply to the run of the suite.
#
# With SEPARATE_RUNS, each test <name>/<test> is a run of its own, with its own fixtures, and
# there are no others. They do not run concurrently, unless RESOURCE_LOCK names something else
# than the suite.
#
# rtf_add_test(<plug-in> [NAME <name>] [PARAM <text>] [ROBOT_ENVIRONMENT <text>]
#              [CONFIGURATIONS <configuration>…] <common>…)
#
# Adds a CTest test that runs one plug-in: a target or a file. PARAM is its
# parameter string, ROBOT_ENVIRONMENT the suite's environment string.
#
# Common arguments
#   LABELS <label>…          for ctest -L
#   RESOURCE_LOCK <name>…    tests with the same lock do not run concurrently
#   TIMEOUT <seconds>        after which rtf stops the run, with hooks and tear-down, as after
#                            SIGTERM. CTest kills everything 90 s later, also the guard of rtf.
#                            (Without the program `timeout`, CTest does so at once.)
#   ENVIRONMENT <name=value>…
#   CONFIGURATIONS <configuration>…
#   WORKING_DIRECTORY <directory>   for rtf-results; default: the binary directory
#   COST <number>, PROCESSORS <number>   properties of CTest

# Sets `command` to the words before `rtf run` that limit its time, and `limit` to the time
# after which CTest may kill it. A run stops in order within 60 s, the default of
# `rtf run --shutdown-timeout`.
function(_rtf_limit_time seconds command limit)
  set(${command} "" PARENT_SCOPE)
  set(${limit} "${seconds}" PARENT_SCOPE)
  if(NOT "${seconds}" MATCHES "^([0-9]+([.][0-9]*)?)?$")
    message(FATAL_ERROR "TIMEOUT ${seconds}: expected a number of seconds")
  endif()
  find_program(RTF_TIMEOUT_PROGRAM timeout)
  mark_as_advanced(RTF_TIMEOUT_PROGRAM)
  if(seconds AND RTF_TIMEOUT_PROGRAM)
    set(${command} "${RTF_TIMEOUT_PROGRAM}" --foreground "${seconds}" PARENT_SCOPE)
    string(REGEX REPLACE "[.].*$" "" whole "${seconds}")
    math(EXPR whole "${whole} + 90")
    set(${limit} "${whole}" PARENT_SCOPE)
  endif()
endfunction()

# Parses the arguments of both commands into arg_….
macro(_rtf_test_words command)
  cmake_parse_arguments(PARSE_ARGV 1 arg "SEPARATE_RUNS"
    "NAME;PARAM;ROBOT_ENVIRONMENT;JUNIT;TIMEOUT;WORKING_DIRECTORY;COST;PROCESSORS"
    "PLUGINS;PLUGIN_PATH;LABELS;RESOURCE_LOCK;ENVIRONMENT;CONFIGURATIONS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "${command}: unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT TARGET rtf::runner)
    message(FATAL_ERROR "${command}: the program `rtf` is not installed")
  endif()
  if(NOT DEFINED arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
endmacro()

function(rtf_add_plugin)
  robottestingframework_add_plugin(${ARGN})
endfunction()

# Sets `result` to RTF_PLUGIN_PATH=… with the directories of targets and further ones; without
# either, with those of all plug-ins that were added before.
function(_rtf_plugin_path targets directories result)
  if(NOT targets AND NOT directories)
    get_property(targets GLOBAL PROPERTY rtf_plugins)
  endif()
  foreach(target IN LISTS targets)
    list(APPEND directories "$<TARGET_FILE_DIR:${target}>")
  endforeach()
  set(${result} "" PARENT_SCOPE)
  if(directories)
    string(REPLACE ";" ":" directories "${directories}")
    set(${result} "RTF_PLUGIN_PATH=${directories}" PARENT_SCOPE)
  endif()
endfunction()

function(rtf_add_suite suite)
  if(suite STREQUAL "NAME" OR "RTF_TEST" IN_LIST ARGN) # the command of RTF 1.x
    robottestingframework_add_suite(${suite} ${ARGN})
    return()
  endif()
  _rtf_test_words("rtf_add_suite(${suite})")
  if(DEFINED arg_PARAM OR DEFINED arg_ROBOT_ENVIRONMENT)
    message(FATAL_ERROR "rtf_add_suite(${suite}): parameters and environment are in the suite")
  endif()
  get_filename_component(file "${suite}" ABSOLUTE)
  if(NOT DEFINED arg_NAME)
    get_filename_component(arg_NAME "${suite}" NAME_WE)
  endif()
  if(arg_SEPARATE_RUNS)
    if(arg_JUNIT)
      message(FATAL_ERROR "rtf_add_suite(${suite}): JUNIT is the report of one run, "
        "but with SEPARATE_RUNS there are several")
    endif()
    if(NOT DEFINED arg_RESOURCE_LOCK)
      set(arg_RESOURCE_LOCK "${arg_NAME}")
    endif()
  endif()

  _rtf_plugin_path("${arg_PLUGINS}" "${arg_PLUGIN_PATH}" plugin_path)
  set(environment ${arg_ENVIRONMENT} ${plugin_path})
  _rtf_limit_time("${arg_TIMEOUT}" limit_command arg_TIMEOUT)
  set(properties "")
  foreach(property RESOURCE_LOCK TIMEOUT COST PROCESSORS)
    if(NOT "${arg_${property}}" STREQUAL "")
      string(REPLACE ";" "\\;" value "${arg_${property}}")
      list(APPEND properties ${property} "${value}")
    endif()
  endforeach()

  # CTest reads the first file, which reads that of its configuration.
  set(base "${CMAKE_CURRENT_BINARY_DIR}/rtf-${arg_NAME}")
  file(WRITE "${base}.cmake"
    "set(configuration \"\${CTEST_CONFIGURATION_TYPE}\")\n"
    "if(NOT EXISTS \"${base}-\${configuration}.cmake\")\n"
    "  set(configuration [==[${CMAKE_BUILD_TYPE}]==])\n"
    "endif()\n"
    "include(\"${base}-\${configuration}.cmake\")\n")
  set(content "")
  foreach(pair "rtf_name=${arg_NAME}" "rtf_cmake=${CMAKE_COMMAND}"
               "rtf_program=$<TARGET_FILE:rtf::runner>"
               "rtf_suite=${file}" "rtf_directory=${arg_WORKING_DIRECTORY}"
               "rtf_base=${base}" "rtf_junit=${arg_JUNIT}"
               "rtf_separate_runs=${arg_SEPARATE_RUNS}")
    string(REGEX REPLACE "^([a-z_]+)=(.*)$" "set(\\1 [==[\\2]==])\n" line "${pair}")
    string(APPEND content "${line}")
  endforeach()
  string(APPEND content
    "set(rtf_environment [==[${environment}]==])\n"
    "set(rtf_limit [==[${limit_command}]==])\n"
    "set(rtf_configurations [==[${arg_CONFIGURATIONS}]==])\n"
    "set(rtf_labels [==[${arg_LABELS}]==])\n"
    "set(rtf_properties [==[${properties}]==])\n"
    "include([==[${_rtf_package_dir}/rtf-suite-tests.cmake]==])\n")
  file(GENERATE OUTPUT "${base}-$<CONFIG>.cmake" CONTENT "${content}")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${base}.cmake")
endfunction()

function(rtf_add_test plugin)
  _rtf_test_words("rtf_add_test(${plugin})")
  if(TARGET "${plugin}")
    set(words "$<TARGET_FILE:${plugin}>")
  else()
    get_filename_component(words "${plugin}" ABSOLUTE)
  endif()
  if(NOT DEFINED arg_NAME)
    get_filename_component(arg_NAME "${plugin}" NAME_WE)
  endif()
  if(arg_SEPARATE_RUNS OR DEFINED arg_JUNIT)
    message(FATAL_ERROR "rtf_add_test(${plugin}): SEPARATE_RUNS and JUNIT are for suites")
  endif()
  if(DEFINED arg_PARAM)
    list(APPEND words "--param=${arg_PARAM}")
  endif()
  if(DEFINED arg_ROBOT_ENVIRONMENT)
    list(APPEND words "--environment=${arg_ROBOT_ENVIRONMENT}")
  endif()
  set(extra "")
  if(arg_CONFIGURATIONS)
    set(extra CONFIGURATIONS ${arg_CONFIGURATIONS})
  endif()
  _rtf_limit_time("${arg_TIMEOUT}" limit_command arg_TIMEOUT)
  add_test(NAME "${arg_NAME}" COMMAND ${limit_command} $<TARGET_FILE:rtf::runner> run ${words}
    WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}" ${extra})
  foreach(property LABELS RESOURCE_LOCK TIMEOUT COST PROCESSORS ENVIRONMENT)
    if(NOT "${arg_${property}}" STREQUAL "")
      set_property(TEST "${arg_NAME}" PROPERTY ${property} ${arg_${property}})
    endif()
  endforeach()
endfunction()
