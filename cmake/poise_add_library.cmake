# poise_add_library(FOLDER HEADERS header... SOURCES source...)
# adds the library poise_FOLDER with the alias poise::FOLDER, which find_package(poise) provides too; of a folder in another,
# statics/proof, they are poise_statics_proof and poise::statics_proof. HEADERS are the public headers, which are installed,
# and SOURCES all sources. Inside the project headers are included from its root ("model/scene.hpp"). Users of an installed
# Poise write <poise/model/scene.hpp>; the include folder include/poise lets the headers find each other there.
# The test includes_look_down holds the includes of FOLDER to what the library links.
function(poise_add_library folder)
  cmake_parse_arguments(arg "" "" "HEADERS;SOURCES" ${ARGN})
  string(REPLACE "/" "_" name "${folder}")
  set(library poise_${name})
  add_library(${library} ${arg_SOURCES})
  add_library(poise::${name} ALIAS ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY poise_folders "${folder}")
  target_compile_features(${library} PUBLIC cxx_std_20)
  target_sources(${library} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${arg_HEADERS})
  target_include_directories(${library} INTERFACE
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/poise>")
  target_link_libraries(${library} PRIVATE fmt::fmt)
  target_precompile_headers(${library} REUSE_FROM ${POISE_PRECOMPILED})
  install(TARGETS ${library} EXPORT poiseTargets
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/poise")
endfunction()

# poise_add_wings(FOLDER WING...)
# adds the libraries of the subfolders WING..., each of which may use those before it, and poise::FOLDER, which stands for
# all of them.
function(poise_add_wings folder)
  set(library poise_${folder})
  add_library(${library} INTERFACE)
  add_library(poise::${folder} ALIAS ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${folder})
  foreach(wing ${ARGN})
    add_subdirectory(${wing})
    target_link_libraries(${library} INTERFACE poise::${folder}_${wing})
  endforeach()
  install(TARGETS ${library} EXPORT poiseTargets)
endfunction()

# poise_compile_apart(LIBRARY PART OPTIONS option... SOURCES source...)
# adds sources to a library that are compiled with other options than the rest of it.
function(poise_compile_apart library part)
  cmake_parse_arguments(arg "" "" "OPTIONS;SOURCES" ${ARGN})
  add_library(${library}_${part} OBJECT ${arg_SOURCES})
  target_compile_features(${library}_${part} PRIVATE cxx_std_20)
  target_compile_options(${library}_${part} PRIVATE ${arg_OPTIONS})
  target_include_directories(${library}_${part} PRIVATE "${PROJECT_SOURCE_DIR}")
  # Those of other libraries, whose warnings are none of ours.
  target_include_directories(${library}_${part} SYSTEM PRIVATE
    $<FILTER:$<TARGET_PROPERTY:${library},INCLUDE_DIRECTORIES>,EXCLUDE,^${PROJECT_SOURCE_DIR}$>)
  target_compile_definitions(${library}_${part} PRIVATE $<TARGET_PROPERTY:${library},COMPILE_DEFINITIONS>)
  target_sources(${library} PRIVATE $<TARGET_OBJECTS:${library}_${part}>)
endfunction()
