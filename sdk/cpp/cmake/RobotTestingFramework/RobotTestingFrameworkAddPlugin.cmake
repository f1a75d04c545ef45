# robottestingframework_add_plugin(<target>
#                                  SOURCES <file>…
#                                  [HEADERS <file>…]
#                                  [LIBRARIES <library or target>…]
#                                  [OUTPUT_NAME <name>])
#
# Adds a plug-in: a module <name>.so without the prefix `lib`. <name> is the
# target's name by default. It is linked to
# RobotTestingFramework::RTF; a project may link that again, in either signature
# of target_link_libraries, which is therefore not called here.
function(robottestingframework_add_plugin target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "OUTPUT_NAME" "SOURCES;HEADERS;LIBRARIES")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR
      "robottestingframework_add_plugin(${target}): unexpected ${arg_UNPARSED_ARGUMENTS}; "
      "files follow SOURCES or HEADERS")
  endif()
  if(NOT arg_SOURCES AND NOT arg_HEADERS)
    message(FATAL_ERROR "robottestingframework_add_plugin(${target}): SOURCES is missing")
  endif()

  add_library(${target} MODULE ${arg_SOURCES} ${arg_HEADERS})
  set_property(GLOBAL APPEND PROPERTY rtf_plugins ${target}) # for rtf_add_suite
  set_property(TARGET ${target} APPEND PROPERTY
    LINK_LIBRARIES RobotTestingFramework::RTF ${arg_LIBRARIES})
  set_target_properties(${target} PROPERTIES PREFIX "")
  if(arg_OUTPUT_NAME)
    set_target_properties(${target} PROPERTIES OUTPUT_NAME "${arg_OUTPUT_NAME}")
  endif()
endfunction()
