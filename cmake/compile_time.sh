#!/bin/sh
# Prints how long the units of a build folder took to compile, from ninja's log: the sum, the sum of each folder and the ten
# that took longest. A unit is a source, or in a unity build several; precompiled headers count as units. The sum stands
# also over the seconds of a unit that only includes Eigen, compiled now, which does not depend on the machine: measured
# on a machine that has nothing else to do.
#   cmake/compile_time.sh BUILD_FOLDER
set -eu

units=$(awk '$4 ~ /\.(o|gch)$/ { took[$4] = ($2 - $1) / 1000 } END { for (s in took) print took[s], s }' \
  "$1/.ninja_log" | sed -E 's,CMakeFiles/([^/]*)\.dir/Unity/,\1/,; s,CMakeFiles/[^/]*/,,' | sort -rn)

# The least of three, in seconds of the processor: `times` prints those of the shell and of what it ran.
yardstick=$(
  for k in 1 2 3; do
    sh -c 'echo "#include <Eigen/Dense>" | ${CXX:-c++} -std=c++20 -O2 $(pkg-config --cflags eigen3) -x c++ -c - -o /dev/null
      times' | tail -1 | awk -F'[ms ]+' '{ print 60 * $1 + $2 + 60 * $3 + $4 }'
  done | sort -n | head -1)

echo "$units" | awk -v yardstick="$yardstick" '
  { sum += $1; sub("/.*", "", $2); folder[$2] += $1; count[$2]++ }
  END {
    for (f in folder) printf "%8.1f s  %3d in %s\n", folder[f], count[f], f | "sort -rn"
    close("sort -rn")
    printf "%8.1f s  %3d in all: %.0f minutes on two cores, %.0f times a unit with only Eigen/Dense (%.2f s); longest:\n",
      sum, NR, sum / 120, sum / yardstick, yardstick
  }'
echo "$units" | head -10 | awk '{ printf "%8.1f s  %s\n", $1, $2 }'
