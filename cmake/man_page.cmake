# Writes the manual page poise.1 from what the program says with --help, so that they agree:
#   cmake -D program=... -D version=... -D output=... -P man_page.cmake
function(help_of variable)
  execute_process(COMMAND "${program}" ${ARGN} --help OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  # Where files are on this machine is not where they will be installed.
  string(REGEX REPLACE "\nOn this machine:\n.*" "" text "${text}")
  string(STRIP "${text}" text)
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

# The text as it stands: no escapes, no requests, not filled.
function(verbatim text variable)
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "\n([.'])" "\n\\\\&\\1" text "${text}")
  set(${variable} ".nf\n${text}\n.fi\n" PARENT_SCOPE)
endfunction()

help_of(help)
string(REGEX REPLACE "\nExamples:\n.*" "" commands "${help}")
string(REGEX REPLACE "^.*\nSubcommands:\n" "\n" commands "${commands}")
string(REGEX MATCHALL "\n  [a-z]+" commands "${commands}")
string(REGEX REPLACE "\n.*" "" summary "${help}")
verbatim("${help}" description)
string(CONCAT page
  ".TH POISE 1 \"\" \"poise ${version}\"\n"
  ".SH NAME\npoise \\- ${summary}\n"
  ".SH SYNOPSIS\n.B poise\n.I COMMAND\n[\\fIOPTION\\fR]...\n"
  ".SH DESCRIPTION\n${description}.SH COMMANDS\n")
foreach(command ${commands})
  string(STRIP "${command}" command)
  help_of(help ${command})
  verbatim("${help}" help)
  string(APPEND page ".SS poise ${command}\n${help}")
endforeach()
string(APPEND page
  ".SH FILES\nDocumentation, example scenes and example programs are installed in share/poise;\n"
  ".B poise \\-\\-help\nnames the folder.\n")
file(WRITE "${output}" "${page}")
