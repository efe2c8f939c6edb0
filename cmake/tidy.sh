#!/bin/sh
# Runs clang-tidy on the sources of some folders in parallel, and prints its output only if there are warnings.
#   cmake/tidy.sh BUILD_FOLDER JOBS FOLDER...
set -eu

build=$1
jobs=$2
shift 2
folders=$(echo "$*" | tr ' ' '|')

if run-clang-tidy -quiet -j "$jobs" -p "$build" "^$PWD/($folders)/.*\.cpp\$" >"$build/clang-tidy.log" 2>&1; then
  echo "clang-tidy: $* clean"
else
  sed -e 's/\x1b\[[0-9;]*m//g' -e '/^clang-tidy/d' -e '/warnings* generated\.$/d' "$build/clang-tidy.log" >&2
  exit 1
fi
