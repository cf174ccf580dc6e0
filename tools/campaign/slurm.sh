#!/bin/sh
# A campaign as a Slurm job array, one shard per task, on a file system that all nodes share:
#   sbatch --array=1-N slurm.sh CASES.jsonl DIR
# Submitted again after an interruption (same N or another), it goes on where it was.
#SBATCH --job-name=stillbase
#SBATCH --ntasks=1
set -eu
[ $# -eq 2 ] || { echo "usage: sbatch --array=1-N $0 CASES.jsonl DIR" >&2; exit 2; }
exec stillbase campaign run "$1" \
  --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --jobs "${SLURM_CPUS_PER_TASK:-1}" -o "$2"
