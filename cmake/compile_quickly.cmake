# Headers that most sources include: parsed once, not once for each source. A source still includes all that it uses;
# `make lint` compiles without precompiled headers. They belong to separate targets, because their users must have the
# definitions that they were compiled with, and may have more. GCC takes the level of optimisation from them, whatever
# the options of the source say, so that there is one such target for each level.
set(POISE_COMMON_HEADERS
  <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map> <memory> <optional> <string> <string_view>
  <utility> <vector> <fmt/format.h>)
# What sources about mechanisms include besides: as long to parse as many of them are to compile.
set(POISE_MECHANICS_HEADERS <Eigen/Dense> <Eigen/SparseCore> <ceres/jet.h> "${PROJECT_SOURCE_DIR}/model/mechanism.hpp")
foreach(headers poise_common_headers poise_mechanics_headers poise_quick_headers)
  add_library(${headers} OBJECT cmake/common_headers.cpp)
  target_link_libraries(${headers} PRIVATE fmt::fmt)
  target_precompile_headers(${headers} PRIVATE ${POISE_COMMON_HEADERS})
endforeach()
foreach(headers poise_mechanics_headers poise_quick_headers)
  target_link_libraries(${headers} PRIVATE Eigen3::Eigen)
  target_include_directories(${headers} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_include_directories(${headers} SYSTEM PRIVATE $<TARGET_PROPERTY:Ceres::ceres,INTERFACE_INCLUDE_DIRECTORIES>)
  target_precompile_headers(${headers} PRIVATE ${POISE_MECHANICS_HEADERS})
endforeach()
# Those of the libraries that are added from here on.
set(POISE_PRECOMPILED poise_common_headers)

# For targets that spend their run time in libraries: fast compilation matters more than fast code. At this level GCC
# takes numbers of Eigen's for uninitialized that are not.
function(poise_compile_quickly target)
  target_compile_options(${target} PRIVATE
    $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>
    $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)
endfunction()
poise_compile_quickly(poise_quick_headers)

# Options of sources in whose loops the time goes.
set(POISE_HOT $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O3>)

# GCC's memory before it looks for what it can free, kB: less than a unit takes.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options("SHELL:--param ggc-min-heapsize=700000")
endif()
