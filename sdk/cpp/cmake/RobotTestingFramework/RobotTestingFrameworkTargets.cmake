# The targets of both packages, RobotTestingFramework and rtf.
#
# This file works where it is installed (<prefix>/lib/cmake/…, headers in
# <prefix>/include, programs in <prefix>/bin) and in the source tree
# (sdk/cpp/cmake/…; the programs are those that cargo has built). Without such a
# program, the `rtf` in PATH is used: the source tree may be there for its headers only.
# The cache variable rtf_EXECUTABLE selects another one.
#
# Sets rtf_INCLUDE_DIRS, rtf_INCLUDE_DIR_1 (the headers of RTF 1.x), rtf_BIN_DIR,
# and rtf_PROBLEM, which is empty when all headers are there.

get_filename_component(_rtf_here "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
set(rtf_INCLUDE_DIRS "")
if(EXISTS "${_rtf_here}/../../include/rtf/TestCase.hpp")
  # The source tree: the C header lies in the C SDK.
  get_filename_component(rtf_INCLUDE_DIRS "${_rtf_here}/../../include" ABSOLUTE)
  get_filename_component(_rtf_folder "${_rtf_here}/../../../c/include" ABSOLUTE)
  set(rtf_INCLUDE_DIR_1 "${rtf_INCLUDE_DIRS}/rtf1")
  list(APPEND rtf_INCLUDE_DIRS "${_rtf_folder}")
  get_filename_component(_rtf_top "${_rtf_here}/../../../.." ABSOLUTE)
  set(_rtf_bin_folders "${_rtf_top}/target/release" "${_rtf_top}/target/debug")
else()
  # <prefix>/lib/cmake/… or, on Debian, <prefix>/lib/<architecture>/cmake/….
  foreach(_rtf_up "../../.." "../../../..")
    get_filename_component(_rtf_folder "${_rtf_here}/${_rtf_up}" ABSOLUTE)
    if(NOT rtf_INCLUDE_DIRS AND EXISTS "${_rtf_folder}/include/rtf/TestCase.hpp")
      set(rtf_INCLUDE_DIRS "${_rtf_folder}/include")
      set(rtf_INCLUDE_DIR_1 "${_rtf_folder}/include/rtf1")
      set(_rtf_bin_folders "${_rtf_folder}/bin")
    endif()
  endforeach()
endif()

set(rtf_PROBLEM "")
set(_rtf_headers rtf/TestCase.hpp rtf/plugin.h)
if(NOT CMAKE_FIND_PACKAGE_NAME STREQUAL "rtf")
  # In Debian, these are in the package robot-testing-framework-compat.
  list(APPEND _rtf_headers robottestingframework/TestCase.h)
endif()
foreach(_rtf_header IN LISTS _rtf_headers)
  unset(_rtf_found)
  foreach(_rtf_folder IN LISTS rtf_INCLUDE_DIRS)
    if(EXISTS "${_rtf_folder}/${_rtf_header}")
      set(_rtf_found TRUE)
    endif()
  endforeach()
  if(NOT _rtf_found)
    set(rtf_PROBLEM
        "the header ${_rtf_header} is not where ${CMAKE_CURRENT_LIST_FILE} expects it")
    return()
  endif()
endforeach()

set(rtf_BIN_DIR "")
if(rtf_EXECUTABLE)
  set(_rtf_bin_folders "")
endif()
foreach(_rtf_folder IN LISTS _rtf_bin_folders)
  if(NOT rtf_BIN_DIR AND EXISTS "${_rtf_folder}/rtf${CMAKE_EXECUTABLE_SUFFIX}")
    set(rtf_BIN_DIR "${_rtf_folder}")
  endif()
endforeach()
if(NOT rtf_BIN_DIR)
  find_program(rtf_EXECUTABLE NAMES rtf DOC "The program rtf")
  if(rtf_EXECUTABLE)
    get_filename_component(rtf_BIN_DIR "${rtf_EXECUTABLE}" DIRECTORY)
  endif()
endif()

if(NOT TARGET RobotTestingFramework::RTF)
  add_library(RobotTestingFramework::RTF INTERFACE IMPORTED)
  set_target_properties(RobotTestingFramework::RTF PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${rtf_INCLUDE_DIRS}")
  if(CMAKE_C_COMPILER_LOADED OR CMAKE_CXX_COMPILER_LOADED) # A project may have only scripts.
    set(THREADS_PREFER_PTHREAD_FLAG TRUE)
    find_package(Threads REQUIRED QUIET)
    set_target_properties(RobotTestingFramework::RTF PROPERTIES
      INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS}")
  endif()
  if(CMAKE_CXX_COMPILER_LOADED) # A project may be in C alone.
    # C++17, but a project that has chosen its standard keeps it: the headers of
    # robot-testing-framework 2.x need C++11.
    set_property(TARGET RobotTestingFramework::RTF PROPERTY INTERFACE_COMPILE_FEATURES
      "$<$<STREQUAL:$<TARGET_PROPERTY:CXX_STANDARD>,>:cxx_std_17>")
  endif()

  add_library(rtf::rtf INTERFACE IMPORTED)
  set_target_properties(rtf::rtf PROPERTIES
    INTERFACE_LINK_LIBRARIES RobotTestingFramework::RTF)
  if(CMAKE_CXX_COMPILER_LOADED)
    set_target_properties(rtf::rtf PROPERTIES INTERFACE_COMPILE_FEATURES cxx_std_17)
  endif()

  foreach(_rtf_part dll lua python ruby)
    add_library(RobotTestingFramework::RTF_${_rtf_part} INTERFACE IMPORTED)
    set_target_properties(RobotTestingFramework::RTF_${_rtf_part} PROPERTIES
      INTERFACE_LINK_LIBRARIES RobotTestingFramework::RTF)
    if(rtf_BIN_DIR AND NOT _rtf_part STREQUAL dll)
      # Scripts are run by the runner, which the loaders call.
      set_target_properties(RobotTestingFramework::RTF_${_rtf_part} PROPERTIES
        INTERFACE_COMPILE_DEFINITIONS
          "ROBOTTESTINGFRAMEWORK_RUNNER=\"${rtf_BIN_DIR}/rtf${CMAKE_EXECUTABLE_SUFFIX}\"")
    endif()
  endforeach()

  if(rtf_BIN_DIR)
    add_executable(rtf::runner IMPORTED)
    set_target_properties(rtf::runner PROPERTIES
      IMPORTED_LOCATION "${rtf_BIN_DIR}/rtf${CMAKE_EXECUTABLE_SUFFIX}")
    set(_rtf_testrunner "${rtf_BIN_DIR}/robottestingframework-testrunner${CMAKE_EXECUTABLE_SUFFIX}")
    if(EXISTS "${_rtf_testrunner}")
      add_executable(RobotTestingFramework::RTF_testrunner IMPORTED)
      set_target_properties(RobotTestingFramework::RTF_testrunner PROPERTIES
        IMPORTED_LOCATION "${_rtf_testrunner}")
    endif()
    unset(_rtf_testrunner)
  endif()
endif()

unset(_rtf_here)
unset(_rtf_top)
unset(_rtf_up)
unset(_rtf_folder)
unset(_rtf_bin_folders)
unset(_rtf_header)
unset(_rtf_headers)
unset(_rtf_found)
unset(_rtf_part)
