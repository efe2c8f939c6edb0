# Sources that use solvers/interval.hpp: the compiler must not assume that results are rounded to nearest, nor fuse a
# product and a sum into one rounding. Precompiled headers belong to other options.
function(poise_directed_rounding)
  set_source_files_properties(${ARGV} PROPERTIES
    COMPILE_OPTIONS "-frounding-math;-ffp-contract=off" SKIP_PRECOMPILE_HEADERS ON)
endfunction()
