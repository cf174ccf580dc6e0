#!/bin/sh
# A cluster of this machine alone, for one command: one_node_slurm.sh DIR COMMAND...
# Starts munged, slurmctld and slurmd (Debian: munge slurmctld slurmd slurm-client) with everything
# that they write in DIR, runs the command with SLURM_CONF set, and stops them again. Exits with 77
# when the cluster cannot be started here: programs missing, not root, or no node that answers.
set -u
dir=$(cd "$1" && pwd) || exit 77
shift
PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sinfo sbatch; do
  command -v "$program" >/dev/null 2>&1 || { echo "no $program" >&2; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "not root" >&2; exit 77; }
mkdir -p "$dir/state" "$dir/spool"
chmod 755 "$dir"
dd if=/dev/urandom of="$dir/munge.key" bs=1024 count=1 2>/dev/null
chmod 400 "$dir/munge.key"
# Two ports that are the test's own.
port=$((20000 + $$ % 20000))
host=$(hostname -s)
cat >"$dir/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge.socket
CredType=cred/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$dir/slurm.conf
munged --force --foreground --socket="$dir/munge.socket" --key-file="$dir/munge.key" \
  --pid-file="$dir/munge.pid" --log-file="$dir/munge.log" --seed-file="$dir/munge.seed" \
  >"$dir/munged.out" 2>&1 &
munged=$!
slurmctld=
slurmd=
stop() {
  for pid in $slurmd $slurmctld $munged; do kill "$pid" 2>/dev/null; done
  wait 2>/dev/null
}
trap stop EXIT
sleep 1
slurmctld -D -c -f "$SLURM_CONF" >"$dir/slurmctld.out" 2>&1 &
slurmctld=$!
slurmd -D -f "$SLURM_CONF" >"$dir/slurmd.out" 2>&1 &
slurmd=$!
tries=0
until sinfo -h -o %T 2>/dev/null | grep -q '^idle'; do
  tries=$((tries + 1))
  if [ "$tries" -gt 30 ]; then
    echo "no node answers" >&2
    tail -n 3 "$dir/munged.out" "$dir/slurmctld.log" "$dir/slurmd.log" >&2
    exit 77
  fi
  sleep 1
done
"$@"
