# The Robot Testing Framework under the names of robot-testing-framework 2.x:
# a project that was written for it builds unchanged.
#
#   find_package(RobotTestingFramework 2 REQUIRED COMPONENTS DLL)
#   robottestingframework_add_plugin(ArmTest SOURCES ArmTest.cpp)
#   target_link_libraries(ArmTest RobotTestingFramework::RTF RobotTestingFramework::RTF_dll)
#
# Components: DLL LUA PYTHON RUBY, all installed.
# Targets
#   RobotTestingFramework::RTF         the headers
#   RobotTestingFramework::RTF_dll, ::RTF_lua, ::RTF_python, ::RTF_ruby
#                                      the same; the loaders of plug-ins
#   RobotTestingFramework::RTF_testrunner
#                                      the program robottestingframework-testrunner
# Variables, for projects that do not link targets
#   RobotTestingFramework_VERSION, RobotTestingFramework_LIBRARIES,
#   RobotTestingFramework_INCLUDEDIR, RobotTestingFramework_INCLUDE_DIRS,
#   RobotTestingFramework_<component>_FOUND, RobotTestingFramework_<component>_INCLUDEDIR
# Commands
#   robottestingframework_add_plugin, robottestingframework_add_suite
#
# The package `rtf` has the new names.

# A project may set an older policy version than this file needs.
cmake_policy(PUSH)
cmake_policy(VERSION 3.16...3.25)

set(RobotTestingFramework_VERSION 2.0.1)

include("${CMAKE_CURRENT_LIST_DIR}/RobotTestingFrameworkTargets.cmake")
if(rtf_PROBLEM)
  set(RobotTestingFramework_FOUND FALSE)
  set(RobotTestingFramework_NOT_FOUND_MESSAGE "${rtf_PROBLEM}")
  cmake_policy(POP)
  return()
endif()

set(RobotTestingFramework_INCLUDE_DIRS "${rtf_INCLUDE_DIRS}")
list(GET rtf_INCLUDE_DIRS 0 RobotTestingFramework_INCLUDEDIR)
set(RobotTestingFramework_LIBRARIES RobotTestingFramework::RTF)
foreach(_rtf_component DLL LUA PYTHON RUBY)
  string(TOLOWER "${_rtf_component}" _rtf_part)
  set(RobotTestingFramework_${_rtf_component}_FOUND TRUE)
  set(RobotTestingFramework_${_rtf_component}_INCLUDEDIR "${RobotTestingFramework_INCLUDEDIR}")
  list(APPEND RobotTestingFramework_LIBRARIES RobotTestingFramework::RTF_${_rtf_part})
endforeach()

include("${CMAKE_CURRENT_LIST_DIR}/RobotTestingFrameworkAddPlugin.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/RobotTestingFrameworkAddSuite.cmake")

foreach(_rtf_component IN LISTS RobotTestingFramework_FIND_COMPONENTS)
  if(NOT RobotTestingFramework_${_rtf_component}_FOUND)
    set(RobotTestingFramework_${_rtf_component}_FOUND FALSE)
    if(RobotTestingFramework_FIND_REQUIRED_${_rtf_component})
      set(RobotTestingFramework_FOUND FALSE)
      set(RobotTestingFramework_NOT_FOUND_MESSAGE
          "there is no component ${_rtf_component}: DLL, LUA, PYTHON, RUBY")
    endif()
  endif()
endforeach()

unset(_rtf_component)
unset(_rtf_part)

cmake_policy(POP)
