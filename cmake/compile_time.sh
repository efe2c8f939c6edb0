#!/bin/sh
# Prints how long the sources of a build folder took to compile, from ninja's log: the sum, the sum of each folder and
# the ten that took longest. Precompiled headers count as sources.
#   cmake/compile_time.sh BUILD_FOLDER
set -eu

sources=$(awk '$4 ~ /\.(o|gch)$/ { took[$4] = ($2 - $1) / 1000 } END { for (s in took) print took[s], s }' \
  "$1/.ninja_log" | sed -E 's,CMakeFiles/[^/]*/,,' | sort -rn)
echo "$sources" | awk '
  { sum += $1; sub("/.*", "", $2); folder[$2] += $1; count[$2]++ }
  END {
    for (f in folder) printf "%8.1f s  %3d in %s\n", folder[f], count[f], f | "sort -rn"
    close("sort -rn")
    printf "%8.1f s  %3d in all; longest:\n", sum, NR
  }'
echo "$sources" | head -10 | awk '{ printf "%8.1f s  %s\n", $1, $2 }'
