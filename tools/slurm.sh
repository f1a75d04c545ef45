#!/usr/bin/env bash
# Runs a command with a private Slurm cluster of two nodes on loopback, and ends the cluster with the command:
#
#   tools/slurm.sh COMMAND [ARGUMENT…]
#
# Slurm and MUNGE are those of Debian's packages. They are unpacked in the user's cache, because installing them
# starts services. The cluster needs root, because `slurmd` does. The command finds `sbatch`, `squeue`, `scancel`,
# `scontrol` and `sinfo` on PATH, and these variables:
#
#   SLURM_CONF          the configuration
#   RTF_SLURM_DIR       the cluster's directory: logs, and NAME.pid of `munged`, `slurmctld`, `n1` and `n2`
#   RTF_SLURM_START     starts the daemon NAME again: `$RTF_SLURM_START n2`

. "$(dirname "$0")/env.sh"
# shellcheck source=tools/packages.sh
. tools/packages.sh

nodes=(n1 n2)
host=$(uname -n)
packages=(libhwloc15 liblua5.1-0 libmunge2 libnuma1 munge slurm-wlm-basic-plugins slurm-client slurmctld slurmd)
clients=(sbatch squeue scancel scontrol sinfo)

[ $# -gt 0 ] || die "name a command: tools/slurm.sh COMMAND"
[ "$(id -u)" -eq 0 ] || die "a Slurm cluster needs root"
have apt-get || die "Slurm is unpacked from Debian's packages, and there is no apt-get"

# Unpacks the packages and prints their directory.
unpack() {
  local version dir client
  version=$(candidate_of slurmd)
  if [ -z "$version" ]; then
    apt update || die "apt-get could not update its lists" "as root: apt-get update"
    version=$(candidate_of slurmd)
  fi
  [ -n "$version" ] || die "apt-get has no package \`slurmd\`"
  dir=$CACHE/slurm-${version//[^A-Za-z0-9.]/-}

  # Only one process at a time may unpack it.
  mkdir -p "$CACHE"
  exec 9>"$dir.lock"
  flock 9
  if [ ! -e "$dir/complete" ]; then
    say "unpacking Slurm $version into $dir"
    rm -rf "$dir"
    mkdir -p "$dir/bin"
    # apt-get as root cannot give files in a home directory to its own user.
    (cd "$dir" && quietly apt-get -qq -o APT::Sandbox::User=root download "${packages[@]}") ||
      die "the packages of Slurm could not be downloaded"
    for package in "$dir"/*.deb; do
      dpkg-deb --extract "$package" "$dir"
    done
    rm "$dir"/*.deb
    for client in "${clients[@]}"; do
      printf '#!/bin/sh\nLD_LIBRARY_PATH=%q exec %q "$@"\n' \
        "$(libraries "$dir")" "$dir/usr/bin/$client" >"$dir/bin/$client"
      chmod +x "$dir/bin/$client"
    done
    touch "$dir/complete"
  fi
  exec 9>&-
  printf '%s' "$dir"
}

# The directories of the libraries.
libraries() {
  local multiarch
  multiarch=$1/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH 2>/dev/null || gcc -print-multiarch)
  printf '%s:%s/slurm-wlm' "$multiarch" "$multiarch"
}

# Prints free ports, one a line.
free_ports() {
  python3 - "$1" <<'PYTHON'
import socket
import sys

sockets = [socket.socket() for _ in range(int(sys.argv[1]))]
for one in sockets:
    one.bind(("127.0.0.1", 0))
    print(one.getsockname()[1])
PYTHON
}

# Prints the configuration. Without `proctrack/cgroup`, because control groups are often not writable in a container;
# with more processors than this machine has.
configuration() {
  local ports
  mapfile -t ports < <(free_ports 3)
  cat <<CONF
ClusterName=rtf
SlurmctldHost=${host%%.*}(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmUser=root
PluginDir=$plugins
AuthType=auth/munge
AuthInfo=socket=$cluster/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1,bf_interval=1
Licenses=robot:1
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
ReturnToService=2
SlurmctldTimeout=10
SlurmdTimeout=5
InactiveLimit=0
KillWait=2
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool/%n
SlurmctldPidFile=$cluster/slurmctld.pid-file
SlurmdPidFile=$cluster/%n.pid-file
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/%n.log
NodeName=${nodes[0]} NodeHostname=${host%%.*} NodeAddr=127.0.0.1 Port=${ports[1]} CPUs=2 RealMemory=1000
NodeName=${nodes[1]} NodeHostname=${host%%.*} NodeAddr=127.0.0.1 Port=${ports[2]} CPUs=2 RealMemory=1000
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
}

# Writes the script that starts a daemon and stores its process id: NAME.
write_start_script() {
  cat >"$cluster/start" <<SCRIPT
#!/bin/bash
export LD_LIBRARY_PATH=$(printf %q "$(libraries "$slurm")") SLURM_CONF=$(printf %q "$cluster/slurm.conf")
cd $(printf %q "$cluster") || exit
case \$1 in
  munged)
    set -- munged $(printf %q "$slurm/usr/sbin/munged") --foreground --key-file="\$PWD/munge/key" \\
      --socket="\$PWD/munge.socket" --pid-file="\$PWD/munge/pid-file" --seed-file="\$PWD/munge/seed" \\
      --log-file="\$PWD/munge/log"
    ;;
  slurmctld) set -- slurmctld $(printf %q "$slurm/usr/sbin/slurmctld-wlm") -D ;;
  *) set -- "\$1" $(printf %q "$slurm/usr/sbin/slurmd-wlm") -D -N "\$1" -d $(printf %q "$slurm/usr/sbin/slurmstepd-wlm") ;;
esac
setsid "\${@:2}" >>"\$1.out" 2>&1 </dev/null 9>&- &
echo \$! >"\$1.pid"
SCRIPT
  chmod +x "$cluster/start"
}

# The processes of the cluster and of its jobs: Slurm gives the configuration to each.
processes() {
  local file
  for file in /proc/[0-9]*/environ; do
    if [ "${file//[!0-9]/}" != $$ ] && grep -qzxF "SLURM_CONF=$cluster/slurm.conf" "$file" 2>/dev/null; then
      printf '%s\n' "${file//[!0-9]/}"
    fi
  done
}

# Signals the processes of the cluster that still run.
signal_processes() {
  local pids
  mapfile -t pids < <(processes)
  [ ${#pids[@]} -eq 0 ] || kill "-$1" "${pids[@]}" 2>/dev/null || true
}

# Whether a command succeeds within some tenths of a second.
within() {
  local tenths=$1
  shift
  until "$@"; do
    [ $((tenths -= 1)) -gt 0 ] || return 1
    sleep 0.1
  done
}

no_jobs() { [ -z "$(squeue --noheader 2>/dev/null)" ]; }
no_processes() { [ -z "$(processes)" ]; }
is_ready() { [ "$(sinfo --noheader --Node --format=%t 2>/dev/null | sort -u)" = idle ]; }

stop() {
  trap - EXIT INT TERM
  [ ! -e "$cluster/slurmctld.pid" ] || no_jobs || { scancel --user=root 2>/dev/null && within 50 no_jobs; } || true
  signal_processes TERM
  within 50 no_processes || { signal_processes KILL && within 50 no_processes; } ||
    say "warning: processes of Slurm are left: $(processes | paste --serial)"
  rm -rf "$cluster"
}

slurm=$(unpack)
plugins=$(dirname "$(find "$slurm/usr/lib" -name auth_munge.so)")
cluster=$(mktemp -d)
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
mkdir -p "$cluster"/{state,munge,spool}
for node in "${nodes[@]}"; do mkdir -p "$cluster/spool/$node"; done
# MUNGE requires that all users can reach its socket.
chmod 711 "$cluster"
chmod 700 "$cluster/munge"
head -c 1024 /dev/urandom >"$cluster/munge/key"
chmod 400 "$cluster/munge/key"
configuration >"$cluster/slurm.conf"
write_start_script

export PATH=$slurm/bin:$PATH SLURM_CONF=$cluster/slurm.conf RTF_SLURM_DIR=$cluster RTF_SLURM_START=$cluster/start
"$RTF_SLURM_START" munged
within 100 [ -S "$cluster/munge.socket" ] || die "\`munged\` does not start" "$(cat "$cluster/munged.out")"
for daemon in slurmctld "${nodes[@]}"; do "$RTF_SLURM_START" "$daemon"; done
within 300 is_ready || die "the Slurm cluster is not ready" "$(tail -n 20 "$cluster"/*.out "$cluster"/*.log)"
"$@"
