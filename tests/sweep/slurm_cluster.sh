#!/bin/bash
# Runs a command in a Slurm cluster of its own: munged, slurmctld and slurmd of Debian's slurm-wlm on
# this machine, with configuration, state and ports of their own, ended with the command.
#   slurm_cluster.sh COMMAND…
# Exit code 77, with the reason, where such a cluster cannot be had.
set -u
skip() { echo "skipped: $1" >&2; exit 77; }
[ "$(id -u)" = 0 ] || skip "slurmd needs root"
for program in munged slurmctld slurmd sbatch sinfo; do
  command -v "$program" > /dev/null || PATH=$PATH:/usr/sbin
  command -v "$program" > /dev/null || skip "no $program (apt install slurm-wlm)"
done
dir=$(mktemp -d /tmp/windhover-slurm-XXXXXX)
host=$(hostname -s)
pids=()
# shellcheck disable=SC2317  # Called by trap.
end() {
  if ((${#pids[@]})); then kill "${pids[@]}" 2> /dev/null; wait "${pids[@]}" 2> /dev/null; fi
  rm -rf "$dir"
}
trap end EXIT
mkdir -p "$dir"/{munge,state,spool}
chmod 0755 "$dir" "$dir/munge"
head -c 1024 /dev/urandom > "$dir/munge.key"
chmod 0400 "$dir/munge.key"
port=$((20000 + $$ % 20000))
cat > "$dir/slurm.conf" << CONF
ClusterName=windhover
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MailProg=/bin/true
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=60 State=UP
CONF
export SLURM_CONF=$dir/slurm.conf
munged --foreground --force --key-file="$dir/munge.key" --socket="$dir/munge/socket" \
  --pid-file="$dir/munge/pid" --log-file="$dir/munge/log" --seed-file="$dir/munge/seed" \
  > "$dir/munged.out" 2>&1 &
pids+=($!)
for _ in $(seq 50); do [ -S "$dir/munge/socket" ] && break; sleep 0.1; done
[ -S "$dir/munge/socket" ] || skip "munged does not start: $(cat "$dir/munged.out" "$dir/munge/log")"
slurmctld -D > "$dir/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -N "$host" > "$dir/slurmd.out" 2>&1 &
pids+=($!)
for _ in $(seq 100); do
  sinfo -h -o %T 2> /dev/null | grep -q '^idle' && up=1 && break
  sleep 0.1
done
[ -n "${up:-}" ] || skip "slurmd does not register: $(tail -3 "$dir/slurmctld.out" "$dir/slurmd.out")"
"$@"
