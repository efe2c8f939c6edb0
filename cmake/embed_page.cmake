# Writes a C++ source that holds the files of app/page/ (app/present/page_parts.hpp):
#   cmake -D page=FOLDER -D output=FILE.cpp -P embed_page.cmake
# The modules are joined to one, twice: all of them, and those of reports, without those of the live page. Lines that
# import and comments are left out, and so are indentation and the word "export" at the beginning of a line. No text of a
# module may go on in a second line therefore.

# As raw literals, each below 60 kB: longer ones are not portable. Cut at ends of lines where there are any, so that no
# letter is cut.
function(literals text variable)
  if(text MATCHES "\\)page\"")
    message(FATAL_ERROR "embed_page: )page\" ends the literals that the page is embedded in; write it in another way")
  endif()
  set(longest 60000)
  set(out "")
  string(LENGTH "${text}" left)
  while(left GREATER 0)
    string(SUBSTRING "${text}" 0 ${longest} piece)
    string(LENGTH "${piece}" size)
    if(size LESS left)
      string(FIND "${piece}" "\n" end REVERSE)
      if(end GREATER 0)
        math(EXPR size "${end} + 1")
        string(SUBSTRING "${piece}" 0 ${size} piece)
      endif()
    endif()
    string(APPEND out "R\"page(${piece})page\",\n")
    string(SUBSTRING "${text}" ${size} -1 text)
    string(LENGTH "${text}" left)
  endwhile()
  set(${variable} "{${out}}" PARENT_SCOPE)
endfunction()

function(joined variable)
  set(scripts "\n")
  foreach(module ${ARGN})
    file(READ "${page}/${module}" text)
    string(APPEND scripts "${text}\n")
  endforeach()
  string(REGEX REPLACE "\nimport [^\n]*" "\n" scripts "${scripts}")
  string(REGEX REPLACE "\nexport " "\n" scripts "${scripts}")
  string(REGEX REPLACE "\n *//[^\n]*" "\n" scripts "${scripts}")
  string(REGEX REPLACE "\n[ \n]+" "\n" scripts "${scripts}")
  if(scripts MATCHES "</script|<!--")
    message(FATAL_ERROR "embed_page: a module holds </script or <!--, which a page cannot contain; split it")
  endif()
  set(${variable} "${scripts}" PARENT_SCOPE)
endfunction()

file(STRINGS "${page}/modules.txt" modules)
joined(live_scripts ${modules})
list(FILTER modules EXCLUDE REGEX "^view")
joined(scripts ${modules})

file(READ "${page}/index.html" skeleton)
file(READ "${page}/page.css" styles)
file(READ "${page}/vendor/uplot/uPlot.min.css" uplot_styles)
file(READ "${page}/vendor/uplot/uPlot.iife.min.js" libraries)
string(PREPEND styles "${uplot_styles}")
foreach(part skeleton styles libraries scripts live_scripts)
  literals("${${part}}" ${part})
endforeach()

file(WRITE "${output}"
  "// Written by cmake/embed_page.cmake from app/page/.\n"
  "#include \"app/present/page_parts.hpp\"\n\n"
  "namespace poise::app {\n\n"
  "PageParts page_parts() {\n"
  "return {\n${skeleton},\n${styles},\n${libraries},\n${scripts},\n${live_scripts}};\n"
  "}\n\n"
  "}  // namespace poise::app\n")
