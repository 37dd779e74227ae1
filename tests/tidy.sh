#!/bin/bash
# clang-tidy with the checks of .clang-tidy over every source file of the engine, the server and the CLI.
# usage: tests/tidy.sh [jobs]     Needs the presets release and asan-ubsan configured.
#
# The second one compiles many of a room's files at a time, and so they are checked: most of the time goes into headers.
# Findings name the file they are in. (A unity file includes sources, the one check that is left out here.) The training
# room is not in it and is checked file by file, but for what includes LibTorch, whose headers clang 14 does not compile
# as C++20.
set -uo pipefail
cd "$(dirname "$0")/.." || exit
[ -f build/asan-ubsan/compile_commands.json ] || { echo "tests/tidy.sh: first cmake --preset asan-ubsan" >&2; exit 1; }
{
  sed -nE 's/^ *"file": "(.*)",?$/build\/asan-ubsan \1/p' build/asan-ubsan/compile_commands.json | grep -E ' .*/(engine|server|clients)/' | grep -v ' .*/tests/'
  git ls-files -- 'engine/training/*.cpp' |
    grep -v -E '/(checkpoint|jet_layer|matrix_product|optimizer|torch_network|row_losses|stiffness_fit|trainer|training_batches)\.cpp$' | sed 's/^/build\/release /'
} | xargs -P "${1:-$(nproc)}" -L 1 sh -c 'clang-tidy -p "$0" --quiet --checks=-bugprone-suspicious-include --extra-arg=-Wno-unknown-warning-option "$1" 2>/dev/null || { echo "clang-tidy: $1 has findings"; exit 1; }'
