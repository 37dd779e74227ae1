#!/bin/bash
# Builds the packages for Debian 12 from the checkout: supple-server, supple, libsupple-dev and python3-supple.
#
#   deploy/build_packages.sh [FOLDER]     writes them into FOLDER (build/packages)
#
# Environment: SUPPLE_BUILD (build/release), the folder of a build to take the programs from, which is brought up to date;
# SUPPLE_JOBS (number of cores); SUPPLE_CMAKE, options of CMake for a build that does not exist yet. SOURCE_DATE_EPOCH, the
# time that files in the packages have, is that of the commit: the same commit gives the same bytes (tests/release).
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in
  -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
  -*) echo "build_packages: unknown argument '$1'; try --help" >&2; exit 2 ;;
esac

folder=$(realpath -m "${1:-build/packages}")
build=$(realpath -m "${SUPPLE_BUILD:-build/release}")
jobs=${SUPPLE_JOBS:-$(nproc)}
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
export SOURCE_DATE_EPOCH
for tool in npm cpack dpkg-shlibdeps xz; do
  command -v "$tool" >/dev/null || { echo "build_packages: '$tool' is missing; see deploy/packages.txt" >&2; exit 1; }
done

(cd clients/web && npm ci && npm run build)
if [ ! -e "$build/CMakeCache.txt" ]; then
  # shellcheck disable=SC2086  # a list of options
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release ${SUPPLE_CMAKE:-}
fi
cmake --build "$build" -j "$jobs"
mkdir -p "$folder"
rm -f "$folder"/supple-server_*.deb "$folder"/supple_*.deb "$folder"/libsupple-dev_*.deb "$folder"/python3-supple_*.deb
# CPack lays the files out in a folder of its own, whose name must not reach the packages.
(cd "$build" && cpack -B "$folder" >"$folder/cpack.log" 2>&1) || { tail -30 "$folder/cpack.log" >&2; exit 1; }
rm -rf "$folder/_CPack_Packages" "$folder"/install_manifest*.txt
ls -l "$folder"/*.deb
