# Writes what bash, zsh and fish read to complete poise, under the names that they look for:
#   cmake -D program=... -D folder=... -P completions.cmake
function(write_completion shell name)
  execute_process(COMMAND "${program}" --completion ${shell} OUTPUT_FILE "${folder}/${name}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(MAKE_DIRECTORY "${folder}")
write_completion(bash poise)
write_completion(zsh _poise)
write_completion(fish poise.fish)
