# ament_add_rtf_suite(<name> FILE <suite.xml> [PER_TEST] [TIMEOUT <seconds>] [LABELS <label>…]
#                     [ENV <name=value>…] [PLUGINS <target>…] [PLUGIN_PATH <directory>…]
#                     [RESOURCE_LOCK <name>…] [WORKING_DIRECTORY <directory>])
#
# Adds a suite to the tests of a package. Its results are in
# <AMENT_TEST_RESULTS_DIR>/<package>/<name>.xunit.xml, where `colcon test-result` looks.
#
# There is one CTest test <name>, which runs the suite. With PER_TEST, the suite runs once, too,
# and each of its tests is also a CTest test <name>/<test>, see rtf_add_suite.
#
# TIMEOUT is the limit of the run, 600 s by default, after which rtf stops it with hooks and
# tear-down. LABELS are added to the label `rtf`. Tests find the plug-ins that the package has
# added by rtf_add_plugin before, or only those of PLUGINS and PLUGIN_PATH. The environment is
# that of `colcon test`, with the environment hooks of the packages on which this one depends.
# WORKING_DIRECTORY, by default the binary directory, contains rtf-results.
function(ament_add_rtf_suite name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "PER_TEST" "FILE;TIMEOUT;WORKING_DIRECTORY"
    "LABELS;ENV;PLUGINS;PLUGIN_PATH;RESOURCE_LOCK")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "ament_add_rtf_suite(${name}): unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_FILE)
    message(FATAL_ERROR "ament_add_rtf_suite(${name}): FILE, the suite, is missing")
  endif()
  get_filename_component(file "${arg_FILE}" ABSOLUTE)
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "ament_add_rtf_suite(${name}): there is no file ${file}")
  endif()
  if(NOT TARGET rtf::runner)
    message(FATAL_ERROR "ament_add_rtf_suite(${name}): the program `rtf` is not installed")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 600) # as for ament_add_test
  endif()
  if(NOT arg_WORKING_DIRECTORY)
    set(arg_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  set(result "${AMENT_TEST_RESULTS_DIR}/${PROJECT_NAME}/${name}.xunit.xml")
  set(labels rtf ${arg_LABELS})

  if(arg_PER_TEST)
    set(further "")
    foreach(word PLUGINS PLUGIN_PATH RESOURCE_LOCK)
      if(arg_${word})
        list(APPEND further ${word} ${arg_${word}})
      endif()
    endforeach()
    rtf_add_suite("${file}" NAME "${name}" JUNIT "${result}" LABELS ${labels}
      TIMEOUT "${arg_TIMEOUT}" ENVIRONMENT ${arg_ENV}
      WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}" ${further})
    return()
  endif()

  _rtf_plugin_path("${arg_PLUGINS}" "${arg_PLUGIN_PATH}" plugin_path)
  _rtf_limit_time("${arg_TIMEOUT}" limit_command limit)
  set(environment ${arg_ENV} ${plugin_path})
  if(environment)
    set(environment ENV ${environment})
  endif()
  ament_add_test("${name}"
    COMMAND ${limit_command} $<TARGET_FILE:rtf::runner> run "${file}" --report "junit=${result}"
    OUTPUT_FILE "${CMAKE_BINARY_DIR}/ament_cmake_rtf/${name}.txt"
    RESULT_FILE "${result}"
    TIMEOUT "${limit}"
    WORKING_DIRECTORY "${arg_WORKING_DIRECTORY}"
    ${environment})
  set_property(TEST "${name}" PROPERTY LABELS ${labels})
  if(arg_RESOURCE_LOCK)
    set_property(TEST "${name}" PROPERTY RESOURCE_LOCK ${arg_RESOURCE_LOCK})
  endif()
endfunction()
