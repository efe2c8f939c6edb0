# Writes poise.pc of what poise::poise links, so that the list is kept in one place, the targets. A linker reads static
# libraries in the order of the list: each must come before those that it uses.
function(poise_collect_links link)
  if(TARGET "${link}")
    get_target_property(aliased "${link}" ALIASED_TARGET)
    if(aliased)
      set(link "${aliased}")
    endif()
  endif()
  get_property(seen GLOBAL PROPERTY poise_links_seen)
  if(link IN_LIST seen)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY poise_links_seen "${link}")
  if(link MATCHES "^PkgConfig::(.+)")
    set_property(GLOBAL APPEND PROPERTY poise_links_requires "${${CMAKE_MATCH_1}_MODULE_NAME}")
    return()
  endif()
  if(TARGET "${link}")
    get_target_property(type "${link}" TYPE)
    get_target_property(is_imported "${link}" IMPORTED)
    if(is_imported AND NOT type STREQUAL "INTERFACE_LIBRARY")
      # Shared libraries know what they use themselves.
      get_target_property(link "${link}" LOCATION)
    else()
      get_target_property(used "${link}" INTERFACE_LINK_LIBRARIES)
      foreach(item ${used})
        string(REGEX REPLACE "^\\$<LINK_ONLY:(.+)>$" "\\1" item "${item}")
        # Other expressions are $<BUILD_INTERFACE:...>: headers that only building Poise needs.
        if(item AND NOT item MATCHES "^\\$<")
          poise_collect_links("${item}")
        endif()
      endforeach()
      if(type STREQUAL "INTERFACE_LIBRARY")
        return()
      endif()
    endif()
  endif()
  string(REGEX REPLACE "^(.*/lib)?([^/]+)$" "\\2" name "${link}")
  string(REGEX REPLACE "\\.(so|a)(\\.[0-9.]+)?$" "" name "${name}")
  get_property(names GLOBAL PROPERTY poise_links_names)
  set_property(GLOBAL PROPERTY poise_links_names "-l${name}" ${names})
endfunction()

poise_collect_links(poise_poise)
get_property(names GLOBAL PROPERTY poise_links_names)
get_property(requires GLOBAL PROPERTY poise_links_requires)
list(JOIN names " " names)
list(JOIN requires ", " requires)
file(RELATIVE_PATH to_prefix "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")
string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")
# Headers of others that those of Poise include.
set(includes "$<TARGET_PROPERTY:poise_poise,INTERFACE_INCLUDE_DIRECTORIES>")
set(includes "$<FILTER:${includes},EXCLUDE,^(${PROJECT_SOURCE_DIR}|${PROJECT_BINARY_DIR})>")
set(includes "$<$<BOOL:${includes}>: -I$<JOIN:$<REMOVE_DUPLICATES:${includes}>, -I>>")
file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/poise.pc" CONTENT
"prefix=\${pcfiledir}/${to_prefix}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: poise
Description: ${PROJECT_DESCRIPTION}
Version: ${PROJECT_VERSION}
Requires: ${requires}
Cflags: -I\${includedir} -I\${includedir}/poise${includes}
Libs: -L\${libdir} ${names}
")
