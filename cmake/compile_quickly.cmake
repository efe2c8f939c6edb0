# Headers that most sources include: parsed once, not once for each source. A source still includes all that it uses;
# `make lint` compiles without precompiled headers. They belong to a separate target, because their users must have the
# definitions that they were compiled with, and may have more.
set(POISE_COMMON_HEADERS
  <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map> <memory> <optional> <string> <string_view>
  <utility> <vector> <fmt/format.h>)
add_library(poise_common_headers OBJECT cmake/common_headers.cpp)
target_link_libraries(poise_common_headers PRIVATE fmt::fmt)
target_precompile_headers(poise_common_headers PRIVATE ${POISE_COMMON_HEADERS})

# For targets that spend their run time in libraries: fast compilation matters more than fast code.
function(poise_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang>>:-O1>)
endfunction()
