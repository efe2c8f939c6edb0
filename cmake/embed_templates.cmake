# Writes a C++ source that holds the templates of `poise view` (app/view/templates.hpp): the rows of a list, NAME|TITLE|FILE,
# with the texts of those files of a folder.
#   cmake -D list=FILE -D folder=FOLDER -D output=FILE.cpp -P embed_templates.cmake

file(STRINGS "${list}" rows)
set(out "")
foreach(row ${rows})
  string(REPLACE "|" ";" row "${row}")
  list(GET row 0 name)
  list(GET row 1 title)
  list(GET row 2 file)
  file(READ "${folder}/${file}" text)
  if(text MATCHES "\\)scene\"")
    message(FATAL_ERROR "embed_templates: )scene\" ends the literal that ${file} is embedded in; write it in another way")
  endif()
  string(APPEND out "{\"${name}\", \"${title}\", \"${file}\", R\"scene(${text})scene\"},\n")
endforeach()

file(WRITE "${output}"
  "// Written by cmake/embed_templates.cmake from app/view/templates.txt.\n"
  "#include \"app/view/templates.hpp\"\n\n"
  "namespace poise::app {\n\n"
  "const std::vector<SceneTemplate>& scene_templates() {\n"
  "  static const std::vector<SceneTemplate> all = {\n${out}};\n"
  "  return all;\n"
  "}\n\n"
  "}  // namespace poise::app\n")
