# What most sources include: parsed once, not once for each source. A source still includes all that it uses; `make lint`
# compiles without precompiled headers. They belong to a target of their own, because whoever uses them must define what
# they were compiled with, and may define more.
set(POISE_COMMON_HEADERS
  <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map> <memory> <optional> <string> <string_view>
  <utility> <vector> <fmt/format.h>)
add_library(poise_common_headers OBJECT cmake/common_headers.cpp)
target_link_libraries(poise_common_headers PRIVATE fmt::fmt)
target_precompile_headers(poise_common_headers PRIVATE ${POISE_COMMON_HEADERS})

# For targets that spend their time in what they call: how fast they compile counts for more than how fast they run.
function(poise_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
endfunction()
