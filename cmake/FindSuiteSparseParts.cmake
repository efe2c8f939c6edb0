# Finds single libraries of SuiteSparse, which Debian ships without a CMake package:
#   find_package(SuiteSparseParts COMPONENTS amd ldl ...)  gives the targets  SuiteSparse::amd, SuiteSparse::ldl, ...
# (Not named FindSuiteSparse, because Ceres Solver's package brings a module of that name with other targets.)
find_path(SuiteSparseParts_INCLUDE_DIR SuiteSparse_config.h PATH_SUFFIXES suitesparse)

foreach(part IN LISTS SuiteSparseParts_FIND_COMPONENTS)
  find_library(SuiteSparseParts_${part}_LIBRARY ${part})
  mark_as_advanced(SuiteSparseParts_${part}_LIBRARY)
  if(SuiteSparseParts_INCLUDE_DIR AND SuiteSparseParts_${part}_LIBRARY)
    set(SuiteSparseParts_${part}_FOUND TRUE)
    if(NOT TARGET SuiteSparse::${part})
      add_library(SuiteSparse::${part} UNKNOWN IMPORTED)
      set_target_properties(SuiteSparse::${part} PROPERTIES
        IMPORTED_LOCATION "${SuiteSparseParts_${part}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${SuiteSparseParts_INCLUDE_DIR}")
    endif()
  endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SuiteSparseParts
  REQUIRED_VARS SuiteSparseParts_INCLUDE_DIR
  HANDLE_COMPONENTS)
mark_as_advanced(SuiteSparseParts_INCLUDE_DIR)
