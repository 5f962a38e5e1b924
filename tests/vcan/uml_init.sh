#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The first process of a user-mode Linux whose root is the host's: loads CAN, runs with_vcan.sh in DFDYN_VCAN_SCRATCH, a
# parameter of the kernel's command line, and switches the machine off.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
{
    mount -t proc proc /proc
    mount -t sysfs sysfs /sys
    modules=/usr/lib/uml/modules/$(uname -r)/kernel
    if [[ -d $modules ]]; then # otherwise they are built in
        for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan net/sched/sch_netem; do
            insmod "$modules/$module.ko"
        done
    fi
    # The tests set the clock, which is allowed only on a machine of their own.
    DFDYN_VCAN_OWN_MACHINE=1 "$(dirname "$0")/with_vcan.sh" "$DFDYN_VCAN_SCRATCH"
} >"$DFDYN_VCAN_SCRATCH/init_log" 2>&1
perl -e 'syscall(169, 0xfee1dead, 672274793, 0x4321fedc, 0)' # reboot(2) with power off, because the first process must not end
