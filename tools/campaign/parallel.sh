#!/bin/sh
# A campaign under GNU parallel: N shards, as many at a time as the machine has cores. Run again after
# an interruption, it goes on where it was.
#   parallel.sh CASES.jsonl DIR N
set -eu
[ $# -eq 3 ] || { echo "usage: $0 CASES.jsonl DIR N" >&2; exit 2; }
seq "$3" | parallel --will-cite --line-buffer stillbase campaign run "$1" --shard {}/"$3" -o "$2"
