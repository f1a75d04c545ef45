# The Robot Testing Framework.
#
#   find_package(rtf REQUIRED)
#   rtf_add_plugin(ArmTest SOURCES ArmTest.cpp LIBRARIES my_robot)
#   rtf_add_suite(arm.xml PLUGINS ArmTest LABELS robot RESOURCE_LOCK arm TIMEOUT 300)
#
# Targets
#   rtf::rtf     the headers, C++17
#   rtf::runner  the program rtf
# Commands
#   rtf_add_plugin, rtf_add_suite, rtf_add_test
#
# CMake also finds this file for `find_package(RTF)`, which is what
# robot-testing-framework 1.x was called. That sets RTF_INCLUDE_DIRS and
# RTF_LIBRARIES, with the headers <TestCase.h>, <rtf/TestCase.h> and so on.

# A project may ask for the behaviour of a CMake that is older than what is used here.
cmake_policy(PUSH)
cmake_policy(VERSION 3.16...3.25)

include("${CMAKE_CURRENT_LIST_DIR}/../RobotTestingFramework/RobotTestingFrameworkTargets.cmake")
if(rtf_PROBLEM)
  set(${CMAKE_FIND_PACKAGE_NAME}_FOUND FALSE)
  set(${CMAKE_FIND_PACKAGE_NAME}_NOT_FOUND_MESSAGE "${rtf_PROBLEM}")
  cmake_policy(POP)
  return()
endif()
include("${CMAKE_CURRENT_LIST_DIR}/../RobotTestingFramework/RobotTestingFrameworkAddPlugin.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/../RobotTestingFramework/RobotTestingFrameworkAddSuite.cmake")
set(_rtf_package_dir "${CMAKE_CURRENT_LIST_DIR}")
include("${CMAKE_CURRENT_LIST_DIR}/rtf-tests.cmake")
set(rtf_LIBRARIES rtf::rtf)

if(CMAKE_FIND_PACKAGE_NAME STREQUAL "RTF")
  set(RTF_INCLUDE_DIRS "${rtf_INCLUDE_DIR_1}" ${rtf_INCLUDE_DIRS})
  set(RTF_LIBRARIES RTF::RTF RTF::RTF_dll)
  if(NOT TARGET RTF::RTF)
    add_library(RTF::RTF INTERFACE IMPORTED)
    set_target_properties(RTF::RTF PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES "${rtf_INCLUDE_DIR_1}"
      INTERFACE_LINK_LIBRARIES RobotTestingFramework::RTF)
    add_library(RTF::RTF_dll INTERFACE IMPORTED)
    set_target_properties(RTF::RTF_dll PROPERTIES INTERFACE_LINK_LIBRARIES RTF::RTF)
  endif()
  foreach(_rtf_component IN LISTS RTF_FIND_COMPONENTS)
    if(_rtf_component STREQUAL "DLL")
      set(RTF_DLL_FOUND TRUE)
    elseif(RTF_FIND_REQUIRED_${_rtf_component})
      set(RTF_FOUND FALSE)
      set(RTF_NOT_FOUND_MESSAGE "there is no component ${_rtf_component}: DLL")
    endif()
  endforeach()
  unset(_rtf_component)
endif()

cmake_policy(POP)
