# Writes the tests of a program for ctest: each suite is one, since a process takes longer to start than most tests in it.
# Those whose names match `alone` are tests of their own. Called after the program was built, with program, file (to be
# written), without (a filter of tests that are added elsewhere), alone and timeout.
execute_process(COMMAND "${program}" --gtest_list_tests "--gtest_filter=-${without}" OUTPUT_VARIABLE listed
  COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "[;[]" "_" listed "${listed}")
string(REPLACE "]" "_" listed "${listed}")
string(REPLACE "\n" ";" lines "${listed}")
set(text "")

# Longer ones first, as far as the number of tests tells that.
function(add name filter cost)
  string(APPEND text "add_test([==[${name}]==] [==[${program}]==] --gtest_brief=1 [==[--gtest_filter=${filter}]==])\n"
    "set_tests_properties([==[${name}]==] PROPERTIES TIMEOUT ${timeout} COST ${cost} "
    "SKIP_REGULAR_EXPRESSION \"PASSED  . 0 tests\\\\..*SKIPPED\")\n")
  set(text "${text}" PARENT_SCOPE)
endfunction()

set(suite "")
set(count 0)
set(others "")
foreach(line IN LISTS lines ITEMS "End.")
  if(line MATCHES "^([A-Za-z][^ ]*)\\.($| )")
    set(next "${CMAKE_MATCH_1}")
    if(count GREATER 0)
      add("${suite}" "${suite}.*:-${without}${others}" ${count})
    endif()
    set(suite "${next}")
    set(count 0)
    set(others "")
  elseif(line MATCHES "^  ([^ ]+)")
    set(test "${suite}.${CMAKE_MATCH_1}")
    if(test MATCHES "${alone}")
      add("${test}" "${test}" 10)
      string(APPEND others ":${test}")
    else()
      math(EXPR count "${count} + 1")
    endif()
  endif()
endforeach()
file(WRITE "${file}" "${text}")
