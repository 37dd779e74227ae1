#!/bin/bash
# Runs the API tests against the server in the image, as a container would run it: as the user 10001 without any capability, on a
# read-only root, with only /tmp and the tests' own folder to write to.
#
#   tests/deploy/test_image.sh                                  the image "supple", every test of tests/api
#   tests/deploy/test_image.sh -- tests/api/test_geodesics.py   what follows -- goes to pytest
#
#   --tag NAME         name of the image (supple)
#   --storage FOLDER   the folder that deploy/build_image.sh was given
#
# Runs as root with buildah, without a container runtime: a mount namespace, chroot and the image's files are sufficient. The command
# line client and the program that makes test models are those of SUPPLE_BUILD (build/release). The Python tests run outside of the image.
set -euo pipefail
cd "$(dirname "$0")/../.."

fail() { printf 'test_image: %s\n' "$*" >&2; exit 1; }

tag=supple
storage=""
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,13s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --) shift; break ;;
    --tag | --storage) [ $# -gt 1 ] || fail "$1 needs a value" ;;
    *) fail "unknown argument '$1'; try --help" ;;
  esac
  case "$1" in
    --tag) tag=$2 ;;
    --storage) storage=$(realpath -m "$2") ;;
  esac
  shift 2
done
[ "$(id -u)" = 0 ] || fail "only root can change into the image's folders"
command -v buildah >/dev/null || fail "buildah is missing: apt-get install buildah"
build=$(realpath -m "${SUPPLE_BUILD:-build/release}")
for program in clients/cli/supple tests/support/make_test_model; do
  [ -x "$build/$program" ] || fail "$build/$program is missing: build the target $(basename "$program"), or set SUPPLE_BUILD"
done

store=(--storage-driver vfs)
[ -z "$storage" ] || store+=(--root "$storage/images" --runroot "$storage/run")
container=$(buildah "${store[@]}" from --pull-never "$tag") || fail "there is no image '$tag': deploy/build_image.sh makes it"
root=$(buildah "${store[@]}" mount "$container")
work=$(mktemp -d /var/tmp/supple-image-XXXXXX)
# shellcheck disable=SC2317  # the trap calls it
cleanup() { buildah "${store[@]}" rm "$container" >/dev/null; rm -rf --one-file-system "$work"; }
trap cleanup EXIT

# The environment and the entry point of the image.
entry=$(buildah "${store[@]}" inspect --format '{{index .Docker.Config.Entrypoint 0}}' "$container")
mapfile -t environment < <(buildah "${store[@]}" inspect --format '{{range .Docker.Config.Env}}{{println .}}{{end}}' "$container" | grep .)
user=$(buildah "${store[@]}" inspect --format '{{.Docker.Config.User}}' "$container")
health=$(buildah "${store[@]}" inspect --format '{{if .Docker.Config.Healthcheck}}{{.Docker.Config.Healthcheck.Test}}{{end}}' "$container")
[ "$user" = 10001:10001 ] || fail "the image runs as '$user', not as 10001:10001"
[ -n "$health" ] || fail "the image has lost its health check: build it with --format docker"
echo "image $tag: runs $entry as $user, health check $health"

# All writable folders are within one folder with the same name outside and inside, so that the tests find the files of their servers.
mkdir -p "$work/root" "$work/data" "$work/tests" "$work/home" "$work/small/disk"
chown 10001:10001 "$work/data" "$work/tests" "$work/home" "$work/small"
chmod 755 "$work"
mkdir -p "$root$work"

# The tests' user has only one additional capability, to change the root, which the server does not have. The process is replaced and
# not forked, so that signals and limits reach the server.
inside="/usr/sbin/chroot $work/root /usr/bin/setpriv --inh-caps=-all --ambient-caps=-all --no-new-privs"
printf '#!/bin/bash\nexec %s /usr/local/bin/%s "$@"\n' "$inside" "$entry" >"$work/supple-server"
printf '#!/bin/bash\nexec %s /usr/bin/env -i %s "$@"\n' "$inside" "${environment[*]@Q}" >"$work/in-the-image"
chmod 755 "$work/supple-server" "$work/in-the-image"

cat >"$work/run" <<'RUN'
set -euo pipefail
root=$1 work=$2 entry=$3 build=$4
shift 4
fail() { printf 'test_image: %s\n' "$*" >&2; exit 1; }
# Enables the loopback device of the new network namespace.
/usr/bin/python3 -c 'import fcntl, socket, struct
fcntl.ioctl(socket.socket(), 0x8914, struct.pack("16sH14x", b"lo", 0x41))'
mount --make-rprivate /
mount --bind "$root" "$work/root"
mount -t proc proc "$work/root/proc"
mount --rbind /dev "$work/root/dev"
mount -t tmpfs -o mode=1777 tmpfs "$work/root/tmp"
mount --bind "$work/data" "$work/root/var/lib/supple"
mount --bind "$work" "$work/root$work"
# Some tests fill a small disk, which the tests' user may not mount.
mount -t tmpfs -o size=64m,mode=700,uid=10001,gid=10001 tmpfs "$work/small/disk"
mount --bind "$work/small/disk" "$work/root$work/small/disk"
mount -o remount,bind,ro "$work/root"
as_user=(setpriv --reuid 10001 --regid 10001 --clear-groups --bounding-set -all,+sys_chroot --inh-caps -all,+sys_chroot
  --ambient-caps -all,+sys_chroot)

# Starts the unchanged image by its entry point. Sets the process and the milliseconds until /readyz is answered.
start_as_it_comes() {
  local began
  began=$(date +%s%N)
  "${as_user[@]}" "$work/in-the-image" "$entry" --open >"$work/start.log" 2>&1 &
  server=$!
  until curl -fsS -o /dev/null --max-time 2 http://127.0.0.1:8080/readyz 2>/dev/null; do
    kill -0 "$server" 2>/dev/null || { cat "$work/start.log" >&2; fail "the server in the image ended"; }
    [ $(($(date +%s%N) - began)) -lt 60000000000 ] || { cat "$work/start.log" >&2; fail "the server was not ready within 60 s"; }
    sleep 0.02
  done
  took=$((($(date +%s%N) - began) / 1000000))
}
stop_as_it_ends() {
  local status=0
  kill -TERM "$server"
  wait "$server" || status=$?
  [ "$status" = 0 ] || fail "the server ended with $status after SIGTERM"
}
start_as_it_comes
first=$took
"${as_user[@]}" "$work/in-the-image" curl -fsS -o /dev/null http://127.0.0.1:8080/healthz || fail "the health check does not pass"
models=$(curl -fsS http://127.0.0.1:8080/v1/models | /usr/bin/python3 -c 'import json, sys; print(len(json.load(sys.stdin)["models"]))')
[ "$models" -gt 0 ] || fail "the image has no models"
curl -fsS http://127.0.0.1:8080/ | grep '<script' >/dev/null || fail "the image has no web editor"
if "${as_user[@]}" "$work/in-the-image" touch /usr/local/written 2>/dev/null; then fail "the root can be written"; fi
stop_as_it_ends
start_as_it_comes
stop_as_it_ends
echo "starts in $first ms, and in $took ms once its files are in memory, with $models models and the editor; its health check passes; SIGTERM ends it with 0"

# Then the tests start its program. They have their own models and expect none beside the program.
mount -t tmpfs -o mode=755,ro tmpfs "$work/root/usr/local/share/supple"
export HOME="$work/home" PYTHONDONTWRITEBYTECODE=1 SUPPLE_TEST_SERVER="$work/supple-server" SUPPLE_TEST_SMALL_DISK="$work/small/disk"
# The checkout and the build belong to another user than the one that runs the tests. Git shows the history of such a checkout only
# with this setting, and "cmake --install" writes a list of the installed files into the build's folder.
export GIT_CONFIG_COUNT=1 GIT_CONFIG_KEY_0=safe.directory GIT_CONFIG_VALUE_0="$PWD"
install -o 10001 -g 10001 -m 644 /dev/null "$work/installed"
[ -e "$build/install_manifest_client.txt" ] || : >"$build/install_manifest_client.txt"
mount --bind "$work/installed" "$build/install_manifest_client.txt"
# PostgreSQL's programs require that their user has a name.
if ! getent passwd 10001 >/dev/null; then
  { cat /etc/passwd; echo "supple:x:10001:10001::$work/home:/usr/sbin/nologin"; } >"$work/passwd"
  mount --bind "$work/passwd" /etc/passwd
fi
[ $# -gt 0 ] || set -- tests/api
exec "${as_user[@]}" /usr/bin/python3 -m pytest -q -p no:cacheprovider --basetemp "$work/tests/run" "$@"
RUN
status=0
unshare --mount --net --propagation private /bin/bash "$work/run" "$root" "$work" "$entry" "$build" "$@" || status=$?
exit $status
