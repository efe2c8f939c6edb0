# Installs Poise into an empty folder, builds the C++ program of README.md against it and runs it there, as a user would.
# Called by ctest with source_dir, build_dir, generator, compiler, flags and build_type.
set(work "${build_dir}/library_example")
set(prefix "${work}/prefix")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

# The text of the first fenced block of C++ that follows the comment `marker` in README.md.
function(read_example marker variable)
  file(READ "${source_dir}/README.md" text)
  string(REPLACE "\r" "" text "${text}")
  foreach(landmark "${marker}" "```cpp\n")
    string(FIND "${text}" "${landmark}" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "README.md: expected the comment ${marker} and after it a block fenced by ```cpp")
    endif()
    string(LENGTH "${landmark}" length)
    math(EXPR at "${at} + ${length}")
    string(SUBSTRING "${text}" ${at} -1 text)
  endforeach()
  string(FIND "${text}" "\n```" end)
  if(end EQUAL -1)
    message(FATAL_ERROR "README.md: the block of C++ after ${marker} has no end")
  endif()
  string(SUBSTRING "${text}" 0 ${end} text)
  set(${variable} "${text}\n" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${work}")
run("${CMAKE_COMMAND}" --install "${build_dir}" --prefix "${prefix}")

read_example("<!-- example: library -->" example)
file(WRITE "${work}/source/example.cpp" "${example}")
file(COPY "${source_dir}/tests/install/CMakeLists.txt" DESTINATION "${work}/source")

# A program that includes every installed header shows that none of them needs one that is not installed.
file(GLOB_RECURSE headers RELATIVE "${prefix}/include" "${prefix}/include/poise/*.hpp")
list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>\n")
list(JOIN headers "" includes)
file(WRITE "${work}/source/all_headers.cpp" "${includes}")

run("${CMAKE_COMMAND}" -S "${work}/source" -B "${work}/build" -G "${generator}" "-DCMAKE_CXX_COMPILER=${compiler}"
  "-DCMAKE_CXX_FLAGS=${flags}" "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_PREFIX_PATH=${prefix}")
run("${CMAKE_COMMAND}" --build "${work}/build")

execute_process(COMMAND "${work}/build/example" datasets/toggle_clamp.toml
  WORKING_DIRECTORY "${prefix}/share/poise" RESULT_VARIABLE result OUTPUT_VARIABLE output)
message("${output}")
if(NOT result EQUAL 0 OR output STREQUAL "")
  message(FATAL_ERROR "the example of README.md ended with ${result}")
endif()

run("${prefix}/bin/poise" --help)
