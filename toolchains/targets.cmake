# The only ways a library is declared, so that one place decides flags and visibility.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

# Everything includes from the repository root: "core/base/status.h".
function(surefoot_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} PUBLIC ${ARG_DEPENDS})
  else()
    add_library(${name} INTERFACE)
    target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR})
    target_link_libraries(${name} INTERFACE ${ARG_DEPENDS})
  endif()
endfunction()

# A core module: no exceptions, no run-time type information, no guarded statics.
function(surefoot_core_library name)
  surefoot_library(${name} ${ARGN})
  get_target_property(type ${name} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    # Stack by function (.su) and, which only g++ can, the calls between functions (.ci): tests/rules.
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti -fno-threadsafe-statics
      -fstack-usage $<$<CXX_COMPILER_ID:GNU>:-fcallgraph-info=su>)
    set_property(GLOBAL APPEND PROPERTY SUREFOOT_CORE_ARCHIVES ${name})
  endif()
endfunction()

# OpenCV's three modules that we use. Debian's single -dev packages ship no CMake configuration; the
# complete libopencv-dev would, at the price of some 400 packages.
if(NOT SUREFOOT_CORE_ONLY)
  find_path(OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
  add_library(surefoot_opencv INTERFACE)
  target_include_directories(surefoot_opencv SYSTEM INTERFACE ${OPENCV_INCLUDE})
  foreach(module core imgproc imgcodecs)
    find_library(OPENCV_${module} opencv_${module} REQUIRED)
    target_link_libraries(surefoot_opencv INTERFACE ${OPENCV_${module}})
  endforeach()
  # The oracle of core/stereo, for tests and benchmarks only.
  find_library(OPENCV_calib3d opencv_calib3d REQUIRED)
  add_library(surefoot_opencv_calib3d INTERFACE)
  target_link_libraries(surefoot_opencv_calib3d INTERFACE surefoot_opencv ${OPENCV_calib3d})
  # Inpainting, for a comparison in surefoot-lab only.
  find_library(OPENCV_photo opencv_photo REQUIRED)
  add_library(surefoot_opencv_photo INTERFACE)
  target_link_libraries(surefoot_opencv_photo INTERFACE surefoot_opencv ${OPENCV_photo})
endif()

# What nearly every file of a group parses anyway, parsed once: a third of the time of ./dev test. Core
# has none, and the presets dev and asan-ubsan switch it off, so that a missing include is noticed.
set(surefoot_common_headers <Eigen/Dense> <algorithm> <array> <memory> <string> <vector>)
