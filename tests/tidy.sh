#!/bin/bash
# clang-tidy with the checks of .clang-tidy over every source file of the engine, the server and the CLI.
# usage: tests/tidy.sh [jobs]     Needs build/release/compile_commands.json.
set -uo pipefail
cd "$(dirname "$0")/.." || exit
# Left out: what includes LibTorch, whose headers clang 14 does not compile as C++20.
git ls-files -- 'engine/*.cpp' 'server/*.cpp' 'clients/cli/*.cpp' |
  grep -v -E '^engine/training/src/(checkpoint|jet_layer|matrix_product|optimizer|torch_network|trainer)\.cpp$' |
  xargs -P "${1:-$(nproc)}" -n 1 sh -c 'clang-tidy -p build/release --quiet --extra-arg=-Wno-unknown-warning-option "$0" 2>/dev/null || { echo "clang-tidy: $0 has findings"; exit 1; }'
