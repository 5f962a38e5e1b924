#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run_vcan_tests.sh PROGRAM [ARGUMENT...]: runs PROGRAM as root with the CAN interface vcan0 for its exclusive use. It runs in a
# network namespace of its own if this machine's kernel supports one with a virtual CAN interface. Otherwise it runs in a user-mode
# Linux that is booted for it, for at most DFDYN_VCAN_SECONDS (170). With DFDYN_VIRTUAL_TIME=KERNEL (virtual_time/build_kernel.sh)
# it runs in that kernel, whose time stops while programs run and jumps over sleeps. DFDYN_UML_PRELOAD: library of large_xstate.cpp.
# Prints the output of PROGRAM and ends with its exit status; a missing status is a failure.
set -euo pipefail

boot_and_run_s=${DFDYN_VCAN_SECONDS:-170}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/uml"
printf '%q ' "$@" >"$scratch/command"

# boot KERNEL [PARAMETER...]: pinned to one core, the last available one. A system call then costs a sixth of its cost on a
# machine that moves between two cores.
boot() {
    local core
    core=$(taskset --cpu-list --pid $$ | sed -E 's/.*[^0-9]([0-9]+)$/\1/')
    timeout --kill-after=5 "$boot_and_run_s" taskset --cpu-list "$core" \
        env LD_PRELOAD="${DFDYN_UML_PRELOAD:-}" "$1" mem=512M \
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
    # Parts that the kernel skips are not needed here and would take longer than the tests.
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
