#!/bin/bash
# Makes a data set with deploy/slurm/make_dataset.sh on a Slurm cluster that consists of this machine, kills two of its twenty tasks
# during their work, and compares the merged file with that of a single run.
#
#   tests/deploy/test_slurm.sh [--lab PROGRAM]     supple-lab (build/release/engine/lab/supple-lab)
#
# Runs as root with Debian's packages slurmctld, slurmd, slurm-client, munge and hdf5-tools. The cluster has its own folder
# and ports, and is removed afterwards.
set -euo pipefail
cd "$(dirname "$0")/../.."

fail() { printf 'test_slurm: %s\n' "$*" >&2; exit 1; }
lab=build/release/engine/lab/supple-lab
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --lab) [ $# -gt 1 ] || fail "$1 needs a value"; lab=$2; shift 2 ;;
    *) fail "unknown argument '$1'; try --help" ;;
  esac
done
[ "$(id -u)" = 0 ] || fail "only root can start a cluster"
for tool in slurmctld slurmd sbatch munged mungekey h5diff; do
  command -v "$tool" >/dev/null || fail "$tool is missing: apt-get install slurmctld slurmd slurm-client munge hdf5-tools"
done
lab=$(realpath "$lab")
[ -x "$lab" ] || fail "$lab is missing: build the target supple-lab"

work=$(mktemp -d)
chmod 711 "$work"
# shellcheck disable=SC2317  # the trap calls it
cleanup() {
  local name
  for name in slurmctld slurmd munged; do [ ! -e "$work/$name.pid" ] || kill "$(cat "$work/$name.pid")" 2>/dev/null || true; done
  sleep 1
  rm -rf "$work"
}
trap cleanup EXIT

host=$(hostname -s)
install -d -m 700 -o munge "$work/munge"
install -d "$work/state" "$work/spool"
mungekey --create --keyfile "$work/munge/key"
chown munge "$work/munge/key"
# A separate munge, so that one of this machine is not affected.
setpriv --reuid munge --regid munge --clear-groups munged --key-file "$work/munge/key" --socket "$work/munge/socket" --pid-file "$work/munge/pid" \
  --log-file "$work/munge/log" --seed-file "$work/munge/seed" --force
cp "$work/munge/pid" "$work/munged.pid"
chmod 711 "$work/munge"
cat >"$work/slurm.conf" <<CONF
ClusterName=proof
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SchedulerParameters=requeue_delay=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld
slurmd -N "$host"
for _ in $(seq 60); do sinfo --noheader --format=%T 2>/dev/null | grep -q idle && break; sleep 0.5; done
sinfo --noheader --format=%T | grep -q idle || { tail "$work"/slurm*.log >&2; fail "the cluster does not come up"; }
echo "a cluster of one node with $(nproc) processors is up"

# Two designs for each shard, a few states each.
recipe=(--family square --designs 40 --seed 3 --mesh-size 0.8 --tension-paths 1 --compression-paths 1 --biaxial-paths 1)
deploy/slurm/make_dataset.sh --folder "$work/array" --shards 20 --lab "$lab" -- "${recipe[@]}"

killed=0
while [ "$killed" -lt 2 ]; do
  # The oldest computing process, which is surely within a design.
  if victim=$(pgrep -o -f "dataset make .*--out $work/array/shard-"); then
    sleep 0.3
    if kill -9 "$victim" 2>/dev/null; then killed=$((killed + 1)); echo "killed process $victim"; fi
  fi
  sleep 0.7
  [ -z "$(ls "$work"/array/dataset.h5 2>/dev/null)" ] || fail "all was done before two tasks could be killed"
done
for _ in $(seq 600); do [ ! -e "$work/array/dataset.h5" ] || break; sleep 1; done
[ -e "$work/array/dataset.h5" ] || { squeue >&2; tail "$work"/array/logs/*.log >&2; fail "the merged data set did not appear within 600 s"; }
again=$(deploy/slurm/make_dataset.sh --folder "$work/array" --shards 20 --lab "$lab" -- "${recipe[@]}")
[[ $again == *"is there already"* ]] || fail "the same command began anew: $again"
other=$(deploy/slurm/make_dataset.sh --folder "$work/array" --shards 20 --lab "$lab" -- "${recipe[@]}" --margin 0.1 2>&1) && fail "another recipe was taken"
[[ $other == *"has another data set"* ]] || fail "another recipe was refused for another reason: $other"

"$lab" dataset make "${recipe[@]}" --quiet --out "$work/alone.h5"
# Only times may differ.
h5diff --exclude-path /rows/seconds --exclude-path /designs/seconds --exclude-path /costs "$work/alone.h5" "$work/array/dataset.h5" ||
  fail "the merged data set differs from that of one run"
h5diff "$work/alone.h5" "$work/array/dataset.h5" /rows/stress >/dev/null
echo "twenty tasks, two of them killed and queued again, made the same data set as one run"
