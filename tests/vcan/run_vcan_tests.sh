#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run_vcan_tests.sh PROGRAM [ARGUMENT...]: runs PROGRAM as root where it has the CAN interface vcan0 to itself: in a network
# namespace of its own where this machine's kernel can make one with a virtual CAN interface, else in a user-mode Linux that is
# booted for it, for DFDYN_VCAN_SECONDS (170) at most. With DFDYN_VIRTUAL_TIME=KERNEL (virtual_time/build_kernel.sh) in that one,
# where time stands still while programs run and jumps over sleeps. Prints what it prints; ends with its status. No status is a
# failure.
set -euo pipefail

boot_and_run_s=${DFDYN_VCAN_SECONDS:-170}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/uml"
printf '%q ' "$@" >"$scratch/command"

# boot KERNEL [PARAMETER...]. Pinned to one core, the last that we may use: a system call costs a sixth of what it costs on a
# machine that moves between two.
boot() {
    local core
    core=$(taskset --cpu-list --pid $$ | sed -E 's/.*[^0-9]([0-9]+)$/\1/')
    timeout --kill-after=5 "$boot_and_run_s" taskset --cpu-list "$core" "$1" mem=512M \
        rootfstype=hostfs rootflags=/ rw "init=$here/uml_init.sh" "DFDYN_VCAN_SCRATCH=$scratch" con=null con0=null,fd:1 \
        quiet "uml_dir=$scratch/uml/" "${@:2}" </dev/null >"$scratch/console" 2>&1 || true
}

if [[ -n ${DFDYN_VIRTUAL_TIME:-} ]]; then
    echo "vcan: user-mode Linux, virtual time"
    # Its wall clock always starts at the same time.
    boot "$DFDYN_VIRTUAL_TIME" time-travel=inf-cpu time-travel-start=1700000000000000000 DFDYN_VIRTUAL_TIME=1
elif [[ $(id -u) -eq 0 ]] && unshare --net ip link add dev vcan0 type vcan 2>/dev/null; then
    echo "vcan: this machine's kernel"
    unshare --net timeout --kill-after=5 "$boot_and_run_s" "$here/with_vcan.sh" "$scratch" || true
elif command -v linux.uml >/dev/null; then
    echo "vcan: user-mode Linux"
    # What the kernel leaves out is not needed here and takes longer than the tests.
    boot linux.uml initcall_blacklist=raid6_select_algo,calibrate_xor_blocks,init_btrfs_fs cryptomgr.notests
else
    echo "vcan: neither can this kernel make a vcan interface (as root), nor is there linux.uml (package user-mode-linux)" >&2
    exit 1
fi

cat "$scratch/output" 2>/dev/null || true
if [[ ! -s $scratch/status ]]; then
    echo "vcan: no status after at most $boot_and_run_s s: the machine did not boot, or the tests did not end" >&2
    tail -n 20 "$scratch/console" "$scratch/init_log" >&2 2>/dev/null || true
    exit 1
fi
exit "$(<"$scratch/status")"
