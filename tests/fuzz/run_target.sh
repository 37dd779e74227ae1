#!/bin/bash
# Runs a fuzz target for some seconds. It starts from the inputs that earlier runs found and from the corpus of this folder.
#
#   tests/fuzz/run_target.sh build/asan-ubsan/tests/fuzz/fuzz_NAME SECONDS
set -uo pipefail
target=$1
name=$(basename "$target")
corpus=build/asan-ubsan/corpus/$name
log=build/asan-ubsan/$name.log
mkdir -p "$corpus"
seeds=()
[ -d "tests/fuzz/corpus/$name" ] && seeds=("tests/fuzz/corpus/$name")
# An input that takes 30 seconds counts as a hang, also on a busy machine.
if "$target" -max_total_time="$2" -timeout=30 -rss_limit_mb=2048 -print_final_stats=1 \
  -artifact_prefix="build/asan-ubsan/$name-" "$corpus" "${seeds[@]}" 2>"$log"; then
  echo "-- $name for $2 s: $(grep -E 'stat::number_of_executed_units' "$log")"
else
  tail -60 "$log"
  exit 1
fi
