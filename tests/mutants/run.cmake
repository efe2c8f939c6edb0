# Do the tests notice an error in a bound or a proof? Each mutant of list.cmake is Poise with one place changed, so that a
# result is rounded inward, or a solution may be lost. It is built and tested; the run fails if its tests pass.
# Called by `make mutants` with source_dir, build_dir, generator, compiler, jobs; `only` is a regular expression for those to
# be tried, "file: name". Called by ctest with check_only, which only looks whether the list fits the sources.
set(work "${build_dir}/mutants")
set(copies "${work}/source")
set(time_limit 120)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
  endif()
endfunction()

# Copies what differs only, so that nothing else is compiled again.
function(restore file)
  configure_file("${source_dir}/${file}" "${copies}/${file}" COPYONLY)
endfunction()

# Tests of a program that fail are in `caught`, which is empty if all pass.
function(test_program program)
  execute_process(COMMAND "${work}/build/${program}" --gtest_brief=1 --gtest_fail_fast TIMEOUT ${time_limit}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result EQUAL 0)
    set(caught "" PARENT_SCOPE)
  elseif(output MATCHES "\\[  FAILED  \\] ([^ ,\n]+)")
    set(caught "${CMAKE_MATCH_1}" PARENT_SCOPE)
  else()
    set(caught "(${result})" PARENT_SCOPE)
  endif()
endfunction()

function(program_of file result)
  if(file MATCHES "^solvers/interval")
    set(${result} interval_mutant PARENT_SCOPE)
  else()
    set(${result} prover_mutant PARENT_SCOPE)
  endif()
endfunction()

# mutant(NAME FILE TEXT REPLACEMENT): TEXT stands in FILE once.
set_property(GLOBAL PROPERTY survivors "")
function(mutant name file text replacement)
  if(only AND NOT "${file}: ${name}" MATCHES "${only}")
    return()
  endif()
  file(READ "${source_dir}/${file}" original)
  string(FIND "${original}" "${text}" first)
  string(FIND "${original}" "${text}" last REVERSE)
  if(first EQUAL -1 OR NOT first EQUAL last)
    message(FATAL_ERROR "tests/mutants/list.cmake: '${name}': expected once in ${file}: ${text}\n"
      "Change the list with the code.")
  endif()
  if(checking)
    return()
  endif()
  string(REPLACE "${text}" "${replacement}" changed "${original}")
  file(WRITE "${copies}/${file}" "${changed}")
  program_of("${file}" program)
  run("${CMAKE_COMMAND}" --build "${work}/build" -j ${jobs} --target ${program})
  test_program(${program})
  restore("${file}")
  if(caught STREQUAL "")
    set(caught "NOT CAUGHT")
    set_property(GLOBAL APPEND PROPERTY survivors "${name}")
  endif()
  string(LENGTH "${file}: ${name}" length)
  math(EXPR gap "90 - ${length}")
  if(gap LESS 1)
    set(gap 1)
  endif()
  string(REPEAT " " ${gap} gap)
  message("${file}: ${name}${gap}${caught}")
endfunction()

# Every mutant must still fit its source before any is built.
set(checking TRUE)
include("${source_dir}/tests/mutants/list.cmake")
set(checking FALSE)
if(check_only)
  return()
endif()

foreach(file solvers/interval.hpp solvers/interval.cpp statics/all_equilibria/private/assembly_modes.cpp
    statics/all_equilibria/private/box_prover.cpp statics/all_equilibria/private/crossing_branches.cpp
    statics/all_equilibria/private/enclosed_set.cpp statics/all_equilibria/private/interval_matrix.hpp
    statics/all_equilibria/private/loop_turns.cpp statics/all_equilibria/private/newton_operator.cpp
    statics/all_equilibria/private/open_angles.cpp)
  restore("${file}")
endforeach()
run("${CMAKE_COMMAND}" --install "${build_dir}" --prefix "${work}/prefix")
# Compiled with few optimisations, which takes less time than the tests gain by more.
run("${CMAKE_COMMAND}" -S "${source_dir}/tests/mutants" -B "${work}/build" -G "${generator}"
  "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_CXX_FLAGS=-O1" "-DCMAKE_PREFIX_PATH=${work}/prefix"
  "-DPOISE_SOURCES=${source_dir}" "-DMUTANT_FOLDER=${copies}")
run("${CMAKE_COMMAND}" --build "${work}/build" -j ${jobs})
foreach(program interval_mutant prover_mutant)
  test_program(${program})
  if(NOT caught STREQUAL "")
    message(FATAL_ERROR "${program} fails without any change: ${caught}")
  endif()
endforeach()

include("${source_dir}/tests/mutants/list.cmake")
get_property(survivors GLOBAL PROPERTY survivors)
if(survivors)
  list(JOIN survivors "\n  " names)
  message(FATAL_ERROR "not caught by any test:\n  ${names}")
endif()
