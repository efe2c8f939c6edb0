# Installs Poise into an empty folder, builds the C++ program of README.md against it and runs it there, as a user would.
# Called by ctest with source_dir, build_dir, generator, compiler, flags and build_type.
set(work "${build_dir}/library_example")
set(prefix "${work}/prefix")
# Programs that run for a moment need no optimization.
set(quick "-O0 -DNDEBUG")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE "${work}")
run("${CMAKE_COMMAND}" --install "${build_dir}" --prefix "${prefix}")

run("${CMAKE_COMMAND}" -D "page=${source_dir}/README.md" -D program=example -D "output=${work}/source/example.cpp"
  -P "${source_dir}/tests/docs/extract_program.cmake")
file(COPY "${source_dir}/tests/install/CMakeLists.txt" DESTINATION "${work}/source")

# A program that includes every installed header shows that none of them needs one that is not installed.
file(GLOB_RECURSE headers RELATIVE "${prefix}/include" "${prefix}/include/poise/*.hpp")
list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>\n")
list(JOIN headers "" includes)
file(WRITE "${work}/source/all_headers.cpp" "${includes}")

run("${CMAKE_COMMAND}" -S "${work}/source" -B "${work}/build" -G "${generator}" "-DCMAKE_CXX_COMPILER=${compiler}"
  "-DCMAKE_CXX_FLAGS=${flags}" "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_CXX_FLAGS_RELEASE=${quick}"
  "-DCMAKE_PREFIX_PATH=${prefix}")
run("${CMAKE_COMMAND}" --build "${work}/build")

execute_process(COMMAND "${work}/build/example" datasets/toggle_clamp.toml
  WORKING_DIRECTORY "${prefix}/share/poise" RESULT_VARIABLE result OUTPUT_VARIABLE output)
message("${output}")
if(NOT result EQUAL 0 OR output STREQUAL "")
  message(FATAL_ERROR "the example of README.md ended with ${result}")
endif()

# The same by the compiler and pkg-config alone, in a folder with a space in its name.
file(CREATE_LINK "${prefix}" "${work}/my prefix" SYMBOLIC)
file(GLOB_RECURSE packages RELATIVE "${prefix}" "${prefix}/*/poise.pc")
cmake_path(GET packages PARENT_PATH packages)
set(ENV{PKG_CONFIG_PATH} "${work}/my prefix/${packages}")
execute_process(COMMAND pkg-config --cflags --libs poise OUTPUT_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY)
# As `eval` reads them.
separate_arguments(words UNIX_COMMAND "${flags} ${words}")
if(NOT words MATCHES "-L[^;]*/my prefix/")
  message(FATAL_ERROR "pkg-config names no folder in ${work}/my prefix: ${words}")
endif()
run("${compiler}" -std=c++20 "${work}/source/example.cpp" -o "${work}/example" ${words})
execute_process(COMMAND "${work}/example" datasets/toggle_clamp.toml
  WORKING_DIRECTORY "${prefix}/share/poise" OUTPUT_VARIABLE by_pkg_config COMMAND_ERROR_IS_FATAL ANY)
if(NOT by_pkg_config STREQUAL output)
  message(FATAL_ERROR "the example of README.md, compiled by pkg-config, says\n${by_pkg_config}")
endif()

# The example of docs/library.md, in its own project: the page shows what is in the installed file and what it prints.
set(examples "${prefix}/share/poise/docs/examples")
set(common -G "${generator}" "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_CXX_FLAGS=${flags}"
  "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_CXX_FLAGS_RELEASE=${quick}")
run("${CMAKE_COMMAND}" -S "${examples}" -B "${work}/installed" ${common} "-DCMAKE_PREFIX_PATH=${prefix}")
run("${CMAKE_COMMAND}" --build "${work}/installed")
execute_process(COMMAND "${work}/installed/press" OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
file(READ "${prefix}/share/poise/docs/library.md" page)
file(READ "${examples}/press.cpp" program)
function(expect_block block)
  string(FIND "${page}" "${block}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "docs/library.md: expected the block\n${block}")
  endif()
endfunction()
expect_block("```cpp\n${program}```\n")
expect_block("```console\n$ build/press\n${output}```\n")

# The same with the sources of Poise. Their libraries are those built already, so that compiling the example is enough.
run("${CMAKE_COMMAND}" -S "${examples}" -B "${work}/sources" ${common} "-DPOISE_SOURCES=${source_dir}")
if(generator MATCHES "Ninja")
  set(object CMakeFiles/press.dir/press.cpp.o)
else()
  set(object press.cpp.o)
endif()
run("${CMAKE_COMMAND}" --build "${work}/sources" --target "${object}")

# What --help of the installed program names is installed with it.
execute_process(COMMAND "${prefix}/bin/poise" --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL " /[^ \n]+" paths "${help}")
file(REAL_PATH "${prefix}" real_prefix)
list(LENGTH paths count)
if(count LESS 5)
  message(FATAL_ERROR "poise --help names ${count} paths, expected 5 or more")
endif()
foreach(path ${paths})
  string(STRIP "${path}" path)
  string(FIND "${path}" "${real_prefix}/share/poise/" at)
  if(NOT at EQUAL 0 OR NOT EXISTS "${path}")
    message(FATAL_ERROR "poise --help names ${path}, which is not installed")
  endif()
endforeach()
foreach(file README.md docs/scene-files.md docs/toggle_clamp.svg datasets/toggle_clamp.toml ../man/man1/poise.1
    ../bash-completion/completions/poise ../zsh/vendor-completions/_poise ../fish/vendor_completions.d/poise.fish)
  if(NOT EXISTS "${prefix}/share/poise/${file}")
    message(FATAL_ERROR "share/poise/${file} is not installed")
  endif()
endforeach()
if(EXISTS "${prefix}/share/poise/docs/site")
  message(FATAL_ERROR "share/poise/docs/site is installed, which only builds the website")
endif()
run("${prefix}/bin/poise" stress --list)
