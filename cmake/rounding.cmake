# Options of sources that use solvers/interval.hpp: the compiler must not assume that results are rounded to nearest.
set(POISE_DIRECTED_ROUNDING -frounding-math)

# Single sources with these options. Precompiled headers belong to other options.
function(poise_directed_rounding)
  set_source_files_properties(${ARGV} PROPERTIES
    COMPILE_OPTIONS "${POISE_DIRECTED_ROUNDING}" SKIP_PRECOMPILE_HEADERS ON)
endfunction()
