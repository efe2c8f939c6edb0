#!/bin/sh
# Runs each fuzz target for a while, one after the other, on inputs that it finds and on those of datasets/ and
# tests/fuzz/seeds, which stay where they are. What is new of interest goes to BUILD_FOLDER/corpus, so that the next run
# goes on from there, and inputs that fail to BUILD_FOLDER/findings. Ends with 1 if there are any.
#   tests/fuzz/run.sh BUILD_FOLDER SECONDS [TARGETS]      called by `make fuzz SECONDS=3600 TARGETS='scene csv'`
set -eu

build=$1
seconds=$2
targets=${3:-scene experiment csv expression http view}
mkdir -p "$build/findings" "$build/tmp"
export TMPDIR="$build/tmp"
# Boost's parser and Eigen keep what they allocate once.
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=0

for target in $targets; do
  mkdir -p "$build/corpus/$target"
  seeds=
  case $target in
    scene | experiment | expression | view) seeds='datasets datasets/hard datasets/friction datasets/structures' ;;
  esac
  if [ -d "tests/fuzz/seeds/$target" ]; then seeds="$seeds tests/fuzz/seeds/$target"; fi
  dictionary=
  if [ -f "tests/fuzz/$target.dict" ]; then dictionary=-dict=tests/fuzz/$target.dict; fi
  echo "fuzz $target: $seconds s"
  # shellcheck disable=SC2086  # several folders
  "$build/tests/fuzz/poise_fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$build/findings/$target-" $dictionary "$build/corpus/$target" $seeds \
    >"$build/$target.log" 2>&1 || true
  grep -E 'stat::number_of_executed_units|SUMMARY|^not as expected|Done [0-9]+ runs' "$build/$target.log" || tail -5 "$build/$target.log"
done

if [ -n "$(ls "$build/findings")" ]; then
  ls "$build"/findings/*
  exit 1
fi
