#!/bin/sh
# Random tests with other seeds than those of `make test`: rounds 1, 2, ... of all of them, each with seeds of its own
# (tests/support/seed.hpp). Rounds that have ended stand in BUILD_FOLDER/campaigns, so that a campaign which was
# interrupted goes on. Prints its command and counts, and what failed with the round; ends with 1 if anything did.
#   tests/campaign.sh BUILD_FOLDER JOBS ROUNDS [TESTS]      called by `make campaign SEEDS=ROUNDS TESTS=regex`
set -eu

build=$1
jobs=$2
rounds=$3
tests=${4:-Random|Mutations}
commit=$(git describe --always --dirty 2>/dev/null || echo unknown)
folder=$build/campaigns/$commit/$(printf %s "$tests" | tr -c 'A-Za-z0-9' _)
mkdir -p "$folder"

for round in $(seq 1 "$rounds"); do
  log=$folder/$round.txt
  if [ -f "$log" ]; then continue; fi
  if [ -t 2 ]; then printf '\rround %d of %d' "$round" "$rounds" >&2; fi
  POISE_CAMPAIGN=$round ctest --test-dir "$build" --parallel "$jobs" --tests-regex "$tests" --no-tests=error \
    --output-on-failure >"$log.part" 2>&1 || true
  if ! grep -q '% tests passed' "$log.part"; then
    cat "$log.part" >&2
    exit 2
  fi
  mv "$log.part" "$log"
done
if [ -t 2 ]; then printf '\r%30s\r' '' >&2; fi

cd "$folder"
for round in $(seq 1 "$rounds"); do
  sed -n "s/^[[:space:]]*[0-9]* - \(.*\) (\(Failed\|Timeout\|SEGFAULT\|Subprocess aborted\).*/round $round: \1: \2/p" "$round.txt"
done
for round in $(seq 1 "$rounds"); do grep '% tests passed' "$round.txt"; done |
  awk -v command="make campaign SEEDS=$rounds TESTS='$tests'" -v commit="$commit" '
    { failed += $4; all += $NF }
    END { printf "%s at %s: %d rounds, %d tests, %d failed\n", command, commit, NR, all, failed; exit failed > 0 }'
