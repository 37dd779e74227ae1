#!/bin/bash
# Builds the container image of the server from the checkout, and says how large it and its parts are.
#
#   deploy/build_image.sh                      on Debian's images, from a registry
#   deploy/build_image.sh --base debootstrap   on a base that debootstrap makes of Debian's packages: needs no registry
#   deploy/build_image.sh --test               ... and then runs the API tests against the server in the image
#
#   --base registry|debootstrap|auto   where Debian comes from; auto (the default) asks the registry and falls back
#   --tag NAME                         name of the image (supple)
#   --storage FOLDER                   where buildah keeps images; without it where it does by itself
#   --mirror URL                       Debian's packages for debootstrap (http://deb.debian.org/debian)
#   --certificates FILE                further certificates that npm trusts while the editor is built; without it the
#                                      file that NODE_EXTRA_CA_CERTS names, if there is one
#   --compiler-cache FOLDER            a folder of ccache that the compilation in the image uses
#   --cmake OPTIONS                    further options of CMake, -DSUPPLE_GROUPED=OFF for example
#   --save FILE                        writes the image as an archive that docker load and podman load read
#   --test                             runs tests/deploy/test_image.sh with the built image
#
# Runs as root on Debian 12 with the packages buildah and, for a base of its own, debootstrap. Without a container
# runtime: buildah's own isolation by chroot is enough. Ends with status 0 only if the image was built, and tested if asked.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { printf 'build_image: %s\n' "$*" >&2; exit 1; }
usage() { printf 'build_image: %s; try --help\n' "$*" >&2; exit 2; }
say() { printf '\n== %s\n' "$*"; }

base=auto
tag=supple
storage=""
mirror=http://deb.debian.org/debian
certificates=${NODE_EXTRA_CA_CERTS:-}
compiler_cache=""
cmake_options=""
archive=""
with_tests=""
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,23s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --test) with_tests=1; shift; continue ;;
    --base | --tag | --storage | --mirror | --certificates | --compiler-cache | --cmake | --save) ;;
    *) usage "unknown argument '$1'" ;;
  esac
  [ $# -gt 1 ] || usage "$1 needs a value"
  case "$1" in
    --base) base=$2 ;;
    --tag) tag=$2 ;;
    --storage) storage=$(realpath -m "$2") ;;
    --mirror) mirror=$2 ;;
    --certificates) certificates=$2 ;;
    --compiler-cache) compiler_cache=$(realpath -m "$2") ;;
    --cmake) cmake_options=$2 ;;
    --save) archive=$(realpath -m "$2") ;;
  esac
  shift 2
done
case "$base" in auto | registry | debootstrap) ;; *) usage "--base is registry, debootstrap or auto, not '$base'" ;; esac
if [ -n "$certificates" ] && [ ! -r "$certificates" ]; then fail "the file of certificates '$certificates' cannot be read"; fi
if [ -n "$archive" ] && [ -e "$archive" ]; then fail "--save: '$archive' exists already"; fi
[ "$(id -u)" = 0 ] || fail "only root can build the image: it mounts and changes into the image's folders"
command -v buildah >/dev/null || fail "buildah is missing: apt-get install buildah"

# vfs needs nothing of the kernel; it copies where other drivers mount, and takes more room while building.
store=(--storage-driver vfs)
[ -z "$storage" ] || store+=(--root "$storage/images" --runroot "$storage/run")
buildah() { command buildah "${store[@]}" "$@"; }

has_image() { buildah inspect --type image "$1" >/dev/null 2>&1; }
registry_answers() { timeout 60 curl -sS -o /dev/null --max-time 20 https://registry-1.docker.io/v2/ 2>/dev/null; }

# What Debian's slim images leave out besides: documents other than licences, manuals and translations.
make_slim() {
  find "$1/usr/share/doc" -depth -type f ! -name copyright -delete
  find "$1/usr/share/doc" -depth -type l -delete
  find "$1/usr/share/doc" -depth -type d -empty -delete
  rm -rf "$1"/usr/share/man/* "$1"/usr/share/info/* "$1"/usr/share/locale/* "$1"/usr/share/lintian/*
}

# Makes a base image of a folder with Debian: its files are copied into an empty image, with their owners.
import_base() {
  local container root
  container=$(buildah from scratch)
  root=$(buildah mount "$container")
  cp -a "$1/." "$root/"
  buildah config --cmd bash --env PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$container"
  buildah commit -q --format docker "$container" "$2" >/dev/null
  buildah rm "$container" >/dev/null
}

base_folder=""
container=""
cleanup() {
  [ -z "$base_folder" ] || rm -rf --one-file-system "$base_folder"
  [ -z "$container" ] || buildah rm "$container" >/dev/null
  base_folder="" container=""
}
trap cleanup EXIT

# The names that the Containerfile builds on, made of packages. Security updates are part of them.
make_bases() {
  local full=docker.io/library/debian:bookworm slim=docker.io/library/debian:bookworm-slim
  if has_image "$full" && has_image "$slim"; then echo "Both images of Debian are here already."; return 0; fi
  command -v debootstrap >/dev/null || fail "debootstrap is missing: apt-get install debootstrap"
  mkdir -p "${storage:-/var/tmp}"
  base_folder=$(mktemp -d "${storage:-/var/tmp}/debian-XXXXXX")
  local log=$base_folder.log
  debootstrap --variant=minbase bookworm "$base_folder" "$mirror" >"$log" 2>&1 ||
    { tail -5 "$log" >&2; fail "debootstrap could not make a base of $mirror; the log is $log"; }
  rm -f "$log"
  chmod 755 "$base_folder"
  # As in Debian's own images: dpkg does not wait for the disk, all security updates are in, and no state of this machine.
  echo force-unsafe-io >"$base_folder/etc/dpkg/dpkg.cfg.d/force-unsafe-io"
  printf '%s\n' "deb $mirror bookworm main" "deb $mirror bookworm-updates main" \
    "deb ${mirror%/debian}/debian-security bookworm-security main" >"$base_folder/etc/apt/sources.list"
  chroot "$base_folder" sh -c 'apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get upgrade -y -q && apt-get clean' >/dev/null
  rm -rf "$base_folder"/var/lib/apt/lists/* "$base_folder"/var/cache/apt/*.bin "$base_folder"/var/log/*.log "$base_folder"/var/log/apt
  rm -f "$base_folder"/etc/machine-id "$base_folder"/etc/resolv.conf "$base_folder"/etc/hostname
  touch "$base_folder/etc/machine-id"
  import_base "$base_folder" "$full"
  make_slim "$base_folder"
  import_base "$base_folder" "$slim"
  cleanup
}

# The bytes of the files in an image, in all and of its largest parts. dpkg's own sizes count what the recipe leaves out.
sizes() {
  {
    (cd "$1/var/lib/dpkg/info" && grep '' -- *.list) | sed -E 's/(:[a-z0-9]+)?\.list:/ /'
    echo
    (cd "$1" && find . -xdev -type f -printf '%s %i %P\n')
  } | awk '
    !listed && NF == 0 { listed = 1; next }
    !listed { path = substr($0, length($1) + 3); sub(/^usr\//, "", path); owner[path] = $1 " (package)"; next }
    $2 in seen { next }
    {
      seen[$2]
      path = substr($0, length($1) + length($2) + 3)
      part = path ~ /^usr\/local\/bin\// ? "/" path : path ~ /^usr\/local\/share\// ? "/usr/local/share/supple" : "others"
      if (path ~ /^usr\/local\/share\/supple\//) { split(path, folders, "/"); part = part "/" folders[5] }
      sub(/^usr\//, "", path)
      if (path in owner) part = owner[path]
      bytes[part] += $1
      all += $1
    }
    END {
      printf "%.1f MB  in all\n", all / 1e6
      for (part in bytes) printf "%.1f MB  %s\n", bytes[part] / 1e6, part
    }' | sort -rn | awk 'NR <= 16'
}

start=$SECONDS
if [ "$base" = auto ]; then
  if registry_answers; then base=registry; else base=debootstrap; fi
fi
pull=(--pull)
if [ "$base" = debootstrap ]; then
  say "Debian 12 by debootstrap, for want of a registry"
  make_bases
  pull=(--pull-never)
fi
base_seconds=$((SECONDS - start))

say "The image $tag"
extra=()
[ -z "$certificates" ] || extra+=(--secret "id=certificates,src=$certificates")
if [ -n "$compiler_cache" ]; then mkdir -p "$compiler_cache"; extra+=(--volume "$compiler_cache:/root/.cache/ccache"); fi
# The recipe sees no history.
if command -v cmake >/dev/null; then cmake_options="-DSUPPLE_VERSION=$(cmake -P cmake/SuppleVersion.cmake) $cmake_options"; fi
[ -z "$cmake_options" ] || extra+=(--build-arg "CMAKE_OPTIONS=$cmake_options")
buildah bud --jobs 2 --isolation chroot --format docker "${pull[@]}" "${extra[@]}" -f deploy/Containerfile -t "$tag" .
build_seconds=$((SECONDS - start - base_seconds))

container=$(buildah from --pull-never "$tag")
root=$(buildah mount "$container")
say "Sizes"
sizes "$root"
cleanup
printf 'base: %d s; build: %d s on %s cores\n' "$base_seconds" "$build_seconds" "$(nproc)"

if [ -n "$archive" ]; then
  buildah push -q "$tag" "docker-archive:$archive:$tag" || fail "the image could not be written to $archive"
  printf 'archive %s: %s\n' "$archive" "$(du -h "$archive" | cut -f1)"
fi
if [ -n "$with_tests" ]; then
  say "The API tests, against the server in the image"
  tests/deploy/test_image.sh --tag "$tag" ${storage:+--storage "$storage"}
fi
