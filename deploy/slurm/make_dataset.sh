#!/bin/bash
# Makes a data set on a cluster: a job array of Slurm, whose tasks make a shard each, and a job that merges the shards.
#
#   deploy/slurm/make_dataset.sh --folder FOLDER [--shards N] [--lab PROGRAM] [--sbatch OPTIONS] -- OPTIONS
#
#   FOLDER             on a file system that all nodes share; the data set becomes FOLDER/dataset.h5
#   --shards N         tasks of the array (20)
#   --lab PROGRAM      supple-lab, where the nodes find it (supple-lab)
#   --sbatch OPTIONS   further options for sbatch, for example "--partition=short --time=2:00:00 --cpus-per-task=4"
#   OPTIONS            of `supple-lab dataset make`, but --out, --shard and --threads
#
# FOLDER/manifest keeps what is made. The same command again submits what is missing, and nothing that Slurm still has: a
# task that was killed goes on with the design that it was at. A killed task is queued again by itself, three times at most.
# The merged file equals the data set that one run makes, in every bit except the times.
set -euo pipefail

fail() { printf 'make_dataset: %s\n' "$*" >&2; exit 1; }
usage() { printf 'make_dataset: %s; try --help\n' "$*" >&2; exit 2; }

folder=""
shards=20
lab=supple-lab
further=""
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --) shift; break ;;
    --folder | --shards | --lab | --sbatch) [ $# -gt 1 ] || usage "$1 needs a value" ;;
    *) usage "unknown argument '$1' before --" ;;
  esac
  case "$1" in
    --folder) folder=$2 ;;
    --shards) shards=$2 ;;
    --lab) lab=$2 ;;
    --sbatch) further=$2 ;;
  esac
  shift 2
done
[ -n "$folder" ] || usage "--folder is missing"
[[ $shards =~ ^[1-9][0-9]{0,4}$ ]] || usage "--shards is a number from 1 to 99999, not '$shards'"
[ $# -gt 0 ] || usage "after -- there are the options of supple-lab dataset make, --family at least"
for argument in "$@"; do
  case "$argument" in
    --out | --out=* | --shard | --shard=* | --threads | --threads=*) usage "$argument is chosen by this script" ;;
  esac
done
for tool in sbatch squeue "$lab"; do command -v "$tool" >/dev/null || fail "there is no program '$tool'"; done
lab=$(realpath "$(command -v "$lab")")

mkdir -p "$folder/logs"
folder=$(realpath "$folder")
# Two at once would submit the same shards.
exec 9>"$folder/lock"
flock -n 9 || fail "another make_dataset.sh is at work in $folder"

options=$(printf ' %q' "$@")
manifest=$(printf 'program: %s\nshards: %s\noptions:%s' "$("$lab" --version)" "$shards" "$options")
if [ -e "$folder/manifest" ]; then
  [ "$(cat "$folder/manifest")" = "$manifest" ] ||
    fail "$folder has another data set; its manifest differs from what is asked for:"$'\n'"$(diff "$folder/manifest" - <<<"$manifest" || true)"
else
  printf '%s\n' "$manifest" >"$folder/manifest.new"
  mv "$folder/manifest.new" "$folder/manifest"
fi
if [ -e "$folder/dataset.h5" ]; then echo "$folder/dataset.h5 is there already."; exit 0; fi

name=supple-$(printf '%s' "$folder" | cksum | cut -d' ' -f1)
if [ -n "$(squeue --noheader --name="$name" --format=%i)" ]; then
  echo "Slurm still has tasks for $folder: squeue --name=$name shows them."
  exit 0
fi
missing=""
for ((k = 0; k < shards; ++k)); do [ -e "$folder/shard-$k.h5" ] || missing+=",$k"; done

# shellcheck disable=SC2206  # a list of options
submit=(sbatch --parsable --job-name="$name" --open-mode=append --requeue $further)
merge=("${submit[@]}" --output="$folder/logs/merge.log" --kill-on-invalid-dep=yes)
if [ -n "$missing" ]; then
  # Expanded by the task. A signal other than its own end means that somebody or something ended the task: the next one goes on.
  # shellcheck disable=SC2016
  task=$(printf '%q dataset make%s --quiet --threads "${SLURM_CPUS_PER_TASK:-1}" --shard "$SLURM_ARRAY_TASK_ID/%s" --out %q"/shard-$SLURM_ARRAY_TASK_ID.h5"' \
    "$lab" "$options" "$shards" "$folder")
  # shellcheck disable=SC2016
  task+=' || { status=$?; [ $status -lt 128 ] || [ "${SLURM_RESTART_COUNT:-0}" -ge 3 ] || scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"; exit $status; }'
  array=$("${submit[@]}" --array="${missing#,}" --output="$folder/logs/shard-%a.log" --wrap="$task")
  merge+=(--dependency="afterok:$array")
  echo "Array $array makes the shards ${missing#,} of 0 to $((shards - 1))."
fi
files=$(for ((k = 0; k < shards; ++k)); do printf ' %q' "$folder/shard-$k.h5"; done)
job=$("${merge[@]}" --wrap="$(printf '%q dataset merge%s --out %q' "$lab" "$files" "$folder/dataset.h5")")
echo "Job $job merges them into $folder/dataset.h5."
