# Is the version of CMakeLists.txt the one of CITATION.cff and the newest of CHANGELOG.md? Called by ctest with source_dir
# and version.
function(expect_version file pattern)
  file(READ "${source_dir}/${file}" text)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${file}: expected a version")
  endif()
  if(NOT CMAKE_MATCH_1 STREQUAL version)
    message(FATAL_ERROR "${file}: expected version ${version} of CMakeLists.txt, found ${CMAKE_MATCH_1}")
  endif()
endfunction()

expect_version(CITATION.cff "\nversion: ([0-9.]+)\n")
expect_version(CHANGELOG.md "\n## \\[([0-9.]+)\\]")
