# The Robot Testing Framework's SDK for C and C++ plug-ins.
#
#   find_package(RobotTestingFramework REQUIRED)
#   robottestingframework_add_plugin(ArmTest SOURCES ArmTest.cpp LIBRARIES my_robot)
#
# Targets
#   RobotTestingFramework::RTF      the headers, C++17
#   RobotTestingFramework::RTF_dll  the same; the predecessor's name for it
# Variables, for projects that do not link targets
#   RobotTestingFramework_INCLUDE_DIRS, RobotTestingFramework_LIBRARIES
#
# This file works where it is installed (<prefix>/lib/cmake/RobotTestingFramework,
# headers in <prefix>/include) and in the source tree (sdk/cpp/cmake).

get_filename_component(_rtf_here "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
set(RobotTestingFramework_INCLUDE_DIRS "")
if(EXISTS "${_rtf_here}/../include/rtf/TestCase.hpp")
  # The source tree: the C header lies in the C SDK.
  foreach(_rtf_folder "${_rtf_here}/../include" "${_rtf_here}/../../c/include")
    get_filename_component(_rtf_folder "${_rtf_folder}" ABSOLUTE)
    list(APPEND RobotTestingFramework_INCLUDE_DIRS "${_rtf_folder}")
  endforeach()
else()
  # <prefix>/lib/cmake/… or, on Debian, <prefix>/lib/<architecture>/cmake/….
  foreach(_rtf_up "../../.." "../../../..")
    get_filename_component(_rtf_folder "${_rtf_here}/${_rtf_up}/include" ABSOLUTE)
    if(NOT RobotTestingFramework_INCLUDE_DIRS AND EXISTS "${_rtf_folder}/rtf/TestCase.hpp")
      set(RobotTestingFramework_INCLUDE_DIRS "${_rtf_folder}")
    endif()
  endforeach()
endif()

foreach(_rtf_header TestCase.hpp plugin.h)
  unset(_rtf_found)
  foreach(_rtf_folder IN LISTS RobotTestingFramework_INCLUDE_DIRS)
    if(EXISTS "${_rtf_folder}/rtf/${_rtf_header}")
      set(_rtf_found TRUE)
    endif()
  endforeach()
  if(NOT _rtf_found)
    set(RobotTestingFramework_FOUND FALSE)
    set(RobotTestingFramework_NOT_FOUND_MESSAGE
        "the header rtf/${_rtf_header} is not where ${CMAKE_CURRENT_LIST_FILE} expects it")
    return()
  endif()
endforeach()

if(NOT TARGET RobotTestingFramework::RTF)
  add_library(RobotTestingFramework::RTF INTERFACE IMPORTED)
  set_target_properties(RobotTestingFramework::RTF PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${RobotTestingFramework_INCLUDE_DIRS}")
  if(CMAKE_CXX_COMPILER_LOADED) # A project may be in C alone.
    set_target_properties(RobotTestingFramework::RTF PROPERTIES
      INTERFACE_COMPILE_FEATURES cxx_std_17)
  endif()
  add_library(RobotTestingFramework::RTF_dll INTERFACE IMPORTED)
  set_target_properties(RobotTestingFramework::RTF_dll PROPERTIES
    INTERFACE_LINK_LIBRARIES RobotTestingFramework::RTF)
endif()
set(RobotTestingFramework_LIBRARIES RobotTestingFramework::RTF)
set(RobotTestingFramework_DLL_FOUND TRUE)

include("${CMAKE_CURRENT_LIST_DIR}/RobotTestingFrameworkAddPlugin.cmake")

foreach(_rtf_component IN LISTS RobotTestingFramework_FIND_COMPONENTS)
  if(NOT _rtf_component STREQUAL "DLL")
    set(RobotTestingFramework_${_rtf_component}_FOUND FALSE)
    if(RobotTestingFramework_FIND_REQUIRED_${_rtf_component})
      set(RobotTestingFramework_FOUND FALSE)
      set(RobotTestingFramework_NOT_FOUND_MESSAGE
          "there is no component ${_rtf_component}: plug-ins in scripting languages need no library")
    endif()
  endif()
endforeach()

unset(_rtf_here)
unset(_rtf_folder)
unset(_rtf_header)
unset(_rtf_found)
unset(_rtf_component)
unset(_rtf_up)
