# Do includes look down? A library is a folder, and what it includes is its own or that of a library that it links. Called by
# ctest with source_dir; graph, a file with a line "FOLDER: poise::LIBRARY..." for each library, in the order in which they
# were added; and work, a folder of its own.
#
# - A library links those before it only, so that no two depend on each other.
# - Each include names a file of the same library, or of one that it links itself.
# - Each library that it links is included.
# - What is in a folder private/ is included by its own library only, and there not by headers for others.
cmake_minimum_required(VERSION 3.25)

# The folder of the library that a file belongs to, among `folders`; empty if there is none.
function(library_of file folders result)
  set(folder "${file}")
  while(NOT folder STREQUAL "" AND NOT folder IN_LIST folders)
    cmake_path(GET folder PARENT_PATH folder)
  endwhile()
  set(${result} "${folder}" PARENT_SCOPE)
endfunction()

# What is wrong in the sources under `root`, one sentence each.
function(objections root graph result)
  set(out "")
  set(folders "")
  set(names "")
  foreach(line IN LISTS graph)
    string(REGEX MATCH "^([^:]+):(.*)$" line "${line}")
    set(folder "${CMAKE_MATCH_1}")
    string(REGEX MATCHALL "poise::[a-z_]+" links "${CMAKE_MATCH_2}")
    set(links_of_${folder} "")
    foreach(link IN LISTS links)
      list(FIND names "${link}" at)
      if(at EQUAL -1)
        list(APPEND out "${folder} links ${link}, which is not before it")
      else()
        list(GET folders ${at} linked)
        list(APPEND links_of_${folder} "${linked}")
      endif()
    endforeach()
    list(APPEND folders "${folder}")
    string(REPLACE "/" "_" name "${folder}")
    list(APPEND names "poise::${name}")
  endforeach()

  foreach(folder IN LISTS folders)
    set(unused "${links_of_${folder}}")
    file(GLOB_RECURSE files RELATIVE "${root}" "${root}/${folder}/*.hpp" "${root}/${folder}/*.cpp")
    foreach(file IN LISTS files)
      library_of("${file}" "${folders}" library)
      if(NOT library STREQUAL folder)
        continue()
      endif()
      file(STRINGS "${root}/${file}" includes REGEX "^#include \"")
      foreach(include IN LISTS includes)
        string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" include "${include}")
        library_of("${include}" "${folders}" included)
        list(REMOVE_ITEM unused "${included}")
        if(NOT included STREQUAL folder)
          if(included STREQUAL "")
            list(APPEND out "${file} includes ${include}, which is of no library")
          elseif(include MATCHES "/private/")
            list(APPEND out "${file} includes ${include}, which is private to ${included}")
          elseif(NOT included IN_LIST links_of_${folder})
            list(APPEND out "${file} includes ${include}, but ${folder} does not link ${included}")
          endif()
        elseif(include MATCHES "/private/" AND file MATCHES "[.]hpp$" AND NOT file MATCHES "/private/")
          list(APPEND out "${file} includes ${include}, which is private, and is not itself")
        endif()
      endforeach()
    endforeach()
    foreach(link IN LISTS unused)
      list(APPEND out "${folder} links ${link}, of which it includes nothing")
    endforeach()
  endforeach()
  set(${result} "${out}" PARENT_SCOPE)
endfunction()

# A house in which all of this is wrong once, and nothing else: the test would notice.
set(house "${work}/house")
file(REMOVE_RECURSE "${work}")
file(WRITE "${house}/ground/floor.hpp" "#include \"house/attic/roof.hpp\"\n#include \"attic/roof.hpp\"\n")
file(WRITE "${house}/ground/private/safe.hpp" "#include \"ground/floor.hpp\"\n")
file(WRITE "${house}/ground/open.hpp" "#include \"ground/private/safe.hpp\"\n")
file(WRITE "${house}/ground/open.cpp" "#include \"ground/private/safe.hpp\"\n")
file(WRITE "${house}/attic/roof.hpp" "#include \"ground/floor.hpp\"\n")
file(WRITE "${house}/attic/private/thief.cpp" "#include \"ground/private/safe.hpp\"\n#include \"attic/roof.hpp\"\n")
file(WRITE "${house}/attic/wing/window.cpp" "#include <vector>\n#include \"attic/wing/window.hpp\"\n")
objections("${house}" "ground: poise::attic;attic: poise::ground;attic/wing: poise::ground" found)
set(expected
  "ground links poise::attic, which is not before it"
  "ground/floor.hpp includes house/attic/roof.hpp, which is of no library"
  "ground/floor.hpp includes attic/roof.hpp, but ground does not link attic"
  "ground/open.hpp includes ground/private/safe.hpp, which is private, and is not itself"
  "attic/private/thief.cpp includes ground/private/safe.hpp, which is private to ground"
  "attic/wing links ground, of which it includes nothing")
if(NOT found STREQUAL expected)
  list(JOIN found "\n  " found)
  message(FATAL_ERROR "includes_look_down does not find what is wrong, but:\n  ${found}")
endif()

file(STRINGS "${graph}" libraries)
objections("${source_dir}" "${libraries}" found)
if(NOT found STREQUAL "")
  list(JOIN found "\n  " found)
  message(FATAL_ERROR "these includes do not look down:\n  ${found}")
endif()
