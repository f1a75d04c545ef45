# `rtf` itself is not part of a workspace: its CMake package `rtf` is installed with it.
find_package(ament_cmake_test QUIET REQUIRED)
find_package(rtf QUIET)
if(NOT rtf_FOUND)
  message(FATAL_ERROR
    "ament_cmake_rtf: the CMake package `rtf` was not found. Install rtf; if it is not installed "
    "in /usr or /usr/local, add its prefix to CMAKE_PREFIX_PATH, or set rtf_DIR.")
endif()
include("${ament_cmake_rtf_DIR}/ament_add_rtf_suite.cmake")
