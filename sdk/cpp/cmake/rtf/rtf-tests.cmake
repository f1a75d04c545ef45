# rtf_add_plugin(<target> SOURCES <file>… [HEADERS …] [LIBRARIES …] [OUTPUT_NAME <name>])
#
# Adds a plug-in, a module without the prefix `lib`.
#
# rtf_add_suite(<suite.xml> [NAME <name>] [PLUGINS <target>…] [PLUGIN_PATH <directory>…] <common>…)
#
# Adds a CTest test <name>/<test> for each test of a suite, with the test's tags
# as labels; CTest finds the tests when it starts. For an invalid suite, for example
# with a missing plug-in, there is one test <name>, which fails with the reason. The
# plug-in path contains the directories in which the PLUGINS are built, and those of
# PLUGIN_PATH. The default NAME is the file's name without its extension. Tests of one
# suite do not run concurrently, unless RESOURCE_LOCK names something else than the
# suite. With CMake before 3.19 there is one test <name> for the whole suite.
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
#   TIMEOUT <seconds>        after which CTest kills it; the guard of rtf still
#                            parks the robot and stops all processes
#   ENVIRONMENT <name=value>…
#   CONFIGURATIONS <configuration>…
#   WORKING_DIRECTORY <directory>   for rtf-results; default: the binary directory
#   COST <number>, PROCESSORS <number>   properties of CTest

# Parses the arguments of both commands into arg_….
macro(_rtf_test_words command)
  cmake_parse_arguments(PARSE_ARGV 1 arg ""
    "NAME;PARAM;ROBOT_ENVIRONMENT;TIMEOUT;WORKING_DIRECTORY;COST;PROCESSORS"
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
  if(NOT DEFINED arg_RESOURCE_LOCK)
    set(arg_RESOURCE_LOCK "${arg_NAME}")
  endif()

  set(directories ${arg_PLUGIN_PATH})
  foreach(plugin IN LISTS arg_PLUGINS)
    list(APPEND directories "$<TARGET_FILE_DIR:${plugin}>")
  endforeach()
  string(REPLACE ";" ":" directories "${directories}")
  set(environment ${arg_ENVIRONMENT})
  if(directories)
    list(APPEND environment "RTF_PLUGIN_PATH=${directories}")
  endif()
  set(properties "")
  foreach(property RESOURCE_LOCK TIMEOUT COST PROCESSORS)
    if(DEFINED arg_${property})
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
               "rtf_suite=${file}" "rtf_directory=${arg_WORKING_DIRECTORY}")
    string(REGEX REPLACE "^([a-z_]+)=(.*)$" "set(\\1 [==[\\2]==])\n" line "${pair}")
    string(APPEND content "${line}")
  endforeach()
  string(APPEND content
    "set(rtf_environment [==[${environment}]==])\n"
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
  add_test(NAME "${arg_NAME}" COMMAND rtf::runner run ${words}
    WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}" ${extra})
  foreach(property LABELS RESOURCE_LOCK TIMEOUT COST PROCESSORS ENVIRONMENT)
    if(DEFINED arg_${property})
      set_property(TEST "${arg_NAME}" PROPERTY ${property} ${arg_${property}})
    endif()
  endforeach()
endfunction()
