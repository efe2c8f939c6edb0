#!/bin/sh
# Runs clang-tidy on sources in parallel, each alone, and prints its output only if there are warnings. In tests and
# benchmarks it looks only for what does not compile alone: a missing include, say, which a unity build hides.
#   cmake/tidy.sh BUILD_FOLDER JOBS changed    sources that are, or include, what differs from the commit in linted_commit
#   cmake/tidy.sh BUILD_FOLDER JOBS all        all sources; then writes the commit into linted_commit, if nothing differs from it
# A commit that is unknown here, or other checks (.clang-tidy), mean all sources.
set -eu

build=$1
jobs=$2
which=$3
linted=cmake/linted_commit
head=$(git rev-parse HEAD 2>/dev/null || echo unknown)

differing_from() {
  git diff --name-only "$1"
  git ls-files --others --exclude-standard
}

# All sources, or those that are named in standard input or include what is named there, directly or by way of others.
# Includes of the project are relative to its root.
affected_sources() {
  { cat; git grep --untracked -o '^#include "[^"]*"' -- '*.cpp' '*.hpp'; } | tr -d '"' | sed 's/:#include / /' | awk '
    NF == 1 { affected[$1] = 1 }
    NF == 2 { from[NR] = $1; to[NR] = $2 }
    END {
      do {
        more = 0
        for (k in from) if (to[k] in affected && !(from[k] in affected)) more = affected[from[k]] = 1
      } while (more)
      for (file in affected) if (file ~ /\.cpp$/) print file
    }'
}

# Shows on a terminal how many sources were begun: run-clang-tidy prints a line for each.
progress() {
  if [ -t 2 ]; then
    awk -v of="$1" '/^[^ ]*clang-tidy/ { printf "\r%d of %d sources", ++begun, of; fflush() } END { printf "\n" }' >&2
  else
    cat >/dev/null
  fi
}

# Runs clang-tidy on the sources named in standard input, of which some may not be compiled here.
tidy() {
  files=$(cat)
  [ "$files" ] || return 0
  rm -f "$build/clang-tidy.failed"
  { run-clang-tidy -quiet -j "$jobs" -p "$build" "$@" "^$PWD/($(echo "$files" | paste -sd '|'))\$" 2>&1 ||
    touch "$build/clang-tidy.failed"; } | tee -a "$build/clang-tidy.log" | progress "$(echo "$files" | wc -l)"
  [ ! -e "$build/clang-tidy.failed" ]
}

commit=$(cat "$linted" 2>/dev/null || echo unknown)
if [ "$which" = changed ] && git diff --quiet "$commit" -- .clang-tidy 2>/dev/null; then
  sources=$(differing_from "$commit" | affected_sources)
else
  commit=
  sources=$(git ls-files --cached --others --exclude-standard '*.cpp')
fi
: >"$build/clang-tidy.log"
failed=
echo "$sources" | grep -vE '^(tests|benchmarks)/' | tidy || failed=yes
echo "$sources" | grep -E '^(tests|benchmarks)/' | tidy '-checks=-*,modernize-use-override' -extra-arg=-Wno-error || failed=yes
if [ "$failed" ]; then
  sed -e 's/\x1b\[[0-9;]*m//g' -e '/^clang-tidy/d' -e '/warnings* generated\.$/d' "$build/clang-tidy.log" >&2
  exit 1
fi
echo "clang-tidy: $(echo "$sources" | grep -c .) sources clean${commit:+ that are affected since $commit}"
if [ "$which" = all ]; then
  if [ "$(differing_from "$head")" ]; then
    echo "clang-tidy: $linted stays as it is, because files differ from the commit that was checked"
  else
    echo "$head" >"$linted"
    echo "clang-tidy: wrote $linted; commit it"
  fi
fi
