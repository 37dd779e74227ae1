#!/bin/bash
# Boots a Debian with systemd in a container of systemd-nspawn, which runs deploy/supple-server.service with the programs of the image.
# Checks that the service starts by the unchanged unit, has its limits, restarts after a kill -9, continues with its data, does not
# restart after it has refused a wrong configuration, and ends with SIGTERM.
#
#   tests/deploy/test_unit.sh [--tag NAME] [--storage FOLDER]      as for deploy/build_image.sh
#
# Runs as root with buildah and systemd-nspawn (Debian's package systemd-container), on the image that deploy/build_image.sh has built.
# Installs systemd from Debian's packages into a copy of it.
set -euo pipefail
cd "$(dirname "$0")/../.."

fail() { printf 'test_unit: %s\n' "$*" >&2; exit 1; }

tag=supple
storage=""
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --tag | --storage) [ $# -gt 1 ] || fail "$1 needs a value" ;;
    *) fail "unknown argument '$1'; try --help" ;;
  esac
  case "$1" in
    --tag) tag=$2 ;;
    --storage) storage=$(realpath -m "$2") ;;
  esac
  shift 2
done
[ "$(id -u)" = 0 ] || fail "only root can boot a container"
command -v buildah >/dev/null || fail "buildah is missing: apt-get install buildah"
command -v systemd-nspawn >/dev/null || fail "systemd-nspawn is missing: apt-get install systemd-container"

store=(--storage-driver vfs)
[ -z "$storage" ] || store+=(--root "$storage/images" --runroot "$storage/run")
container=$(buildah "${store[@]}" from --pull-never "$tag") || fail "there is no image '$tag': deploy/build_image.sh makes it"
root=$(buildah "${store[@]}" mount "$container")
# shellcheck disable=SC2317  # the trap calls it
cleanup() { buildah "${store[@]}" rm "$container" >/dev/null; }
trap cleanup EXIT

cp /etc/resolv.conf "$root/etc/resolv.conf"
chroot "$root" sh -c 'apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends systemd systemd-sysv' \
  >"$root/install.log" 2>&1 || { tail -5 "$root/install.log" >&2; fail "systemd could not be installed"; }
install -D -m 644 -t "$root/etc/systemd/system" deploy/supple-server.service
echo 'SUPPLE_MAX_STORE=2GB' >"$root/etc/default/supple-server"

cat >"$root/proof" <<'PROOF'
#!/bin/bash
set -u
say() { printf '%s\n' "$*" >>/proof.log; }
wrong() { say "WRONG: $*"; }
is() { systemctl show --property "$1" --value supple-server; }
ready() { for _ in $(seq 150); do curl -fsS -o /dev/null --max-time 2 http://127.0.0.1:8080/readyz 2>/dev/null && return 0; sleep 0.2; done; return 1; }

began=$(date +%s%N)
systemctl start supple-server || wrong "the unit does not start"
ready || wrong "the server is not ready"
say "ready $((($(date +%s%N) - began) / 1000000)) ms after systemctl start"
pid=$(is MainPID)
say "user $(stat -c %u "/proc/$pid"), capabilities $(awk '/CapEff/ {print $2}' "/proc/$pid/status"), seccomp $(awk '/^Seccomp:/ {print $2}' "/proc/$pid/status")"
[ "$(stat -c %u "/proc/$pid")" != 0 ] || wrong "the server runs as root"
group=/sys/fs/cgroup$(is ControlGroup)
# The kernel's limits exist only if the container has the controllers.
limit() { cat "$group/$1" 2>/dev/null || echo "not in this container"; }
say "MemoryMax $(is MemoryMax), kernel: $(limit memory.max); TasksMax $(is TasksMax), kernel: $(limit pids.max)"
mesh=$(printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' | curl -fsS --data-binary @- -H 'Content-Type: model/obj' http://127.0.0.1:8080/v1/meshes | sed -E 's/.*"id": ?"([^"]+)".*/\1/')
[ -n "$mesh" ] || wrong "a mesh cannot be stored"
# Meshing runs in a helper process, which the filter of system calls must permit.
curl -fsS -o /dev/null -H 'Content-Type: application/json' http://127.0.0.1:8080/v1/simulations -d '{"family": "IH01",
  "parameters": [0.12, 0.5, 0.1, 0.6], "load": {"uniaxial": {"direction": 0, "stretches": [0.99]}}, "accuracy": {"mesh_size": 0.7}}' ||
  wrong "a simulation does not run"

kill -KILL "$pid"
sleep 3
ready || wrong "the server does not come back after kill -9"
[ "$(is MainPID)" != "$pid" ] && [ "$(is NRestarts)" = 1 ] || wrong "it was not started again: $(is NRestarts) restarts"
curl -fsS -o /dev/null "http://127.0.0.1:8080/v1/meshes/$mesh" || wrong "the mesh is gone after kill -9"
systemctl stop supple-server
[ "$(is Result)" = success ] || wrong "SIGTERM ends it with $(is Result)"

echo 'SUPPLE_PORT=none' >>/etc/default/supple-server
systemctl start supple-server
sleep 5
[ "$(is ExecMainStatus)" = 2 ] && [ "$(is ActiveState)" = failed ] && [ "$(is NRestarts)" = 0 ] ||
  wrong "a wrong configuration ends with $(is ExecMainStatus), $(is ActiveState), $(is NRestarts) restarts"
journalctl -q --no-pager -u supple-server >/journal.log 2>&1
say "all was looked at"
systemctl poweroff
PROOF
chmod 755 "$root/proof"
cat >"$root/etc/systemd/system/proof.service" <<'SERVICE'
[Unit]
Description=Proof of supple-server.service
After=multi-user.target
[Service]
ExecStart=/proof
[Install]
WantedBy=multi-user.target
SERVICE
ln -sf /etc/systemd/system/proof.service "$root/etc/systemd/system/multi-user.target.wants/proof.service"
# There is no system bus to register the container with.
timeout --kill-after=20 300 systemd-nspawn -q --register=no --keep-unit --private-network -D "$root" --boot >"$root/boot.log" 2>&1 ||
  { tail -20 "$root/boot.log" >&2; fail "the container did not boot and end within 5 minutes"; }
cat "$root/proof.log" || { tail -20 "$root/boot.log" >&2; fail "the container booted without the proof"; }
if grep -q WRONG "$root/proof.log" || ! grep -qx "all was looked at" "$root/proof.log"; then
  tail -60 "$root/journal.log" >&2
  fail "the unit does not do what it should"
fi
