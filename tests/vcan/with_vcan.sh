#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# with_vcan.sh SCRATCH: as root, makes vcan0 (CAN FD) and runs the command line in SCRATCH/command. Writes its output to
# SCRATCH/output and finally, atomically, its exit status to SCRATCH/status.
set -euo pipefail

scratch=$1
ip link set lo up
ip link add dev vcan0 type vcan
ip link set vcan0 mtu 72 up
sleep 0.05 # until the timers of a machine that has just booted are precise
status=0
bash -c "$(<"$scratch/command")" >"$scratch/output" 2>&1 </dev/null || status=$?
echo "$status" >"$scratch/status.new"
mv "$scratch/status.new" "$scratch/status"
