#!/bin/bash
# Builds the packages of the present commit twice, in two folders and without a compiler cache, and compares them byte by
# byte. Takes as long as two builds from nothing.
#
#   tests/release/reproducible.sh
#
# Environment: SUPPLE_KEEP=1 leaves the two folders where they are, and says where.
set -euo pipefail
cd "$(dirname "$0")/../.."
case "${1:-}" in
  "") ;;
  -h | --help) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) echo "reproducible: unknown argument '$1'; try --help" >&2; exit 2 ;;
esac
source=$PWD
work=$(mktemp -d)
if [ -n "${SUPPLE_KEEP:-}" ]; then echo "in $work"; else trap 'rm -rf "$work"' EXIT; fi
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH CCACHE_DISABLE=1

for folder in "$work/first" "$work/another folder/second"; do
  git clone -q "$source" "$folder"
  # The tests, the benchmarks and the training are in no package.
  SUPPLE_CMAKE="-DSUPPLE_BUILD_TESTS=OFF -DSUPPLE_TRAINING=OFF -DSUPPLE_GROUPED=ON" SUPPLE_BUILD="" \
    "$folder/deploy/build_packages.sh" "$folder/packages" >"$folder.log" 2>&1 || { tail -30 "$folder.log"; exit 1; }
done
status=0
for package in "$work"/first/packages/*.deb; do
  name=$(basename "$package")
  if cmp -s "$package" "$work/another folder/second/packages/$name"; then
    echo "same bytes: $name ($(stat -c %s "$package"))"
  else
    echo "DIFFERENT: $name"
    status=1
  fi
done
exit $status
