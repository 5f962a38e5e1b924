#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# loop_demo.sh DFDYN OUT [--vcan]: a loop that learns the arm it moves, on the simulated UR5 and on the iCub's right arm, over the
# frames of their devices. For each arm: half a minute under the nominal rigid body, without payload, for the hyperparameters; then a
# minute and a half of another motion with friction and a payload that nothing knows of, and a second payload at 65 s, under the
# nominal rigid body and under a model that begins with nothing learned. Prints both tables.
# Without --vcan in simulated time, frames in memory, in a minute; writes OUT/ARM/tracking.{csv,svg,html} and recordings.
# With --vcan arm and loop are two programs on a virtual CAN interface, at the devices' rates, in a user-mode Linux whose time stands
# still while programs run: some 6 minutes, and 5 for that kernel the first time (build/virtual_time). By measured positions; writes
# OUT/vcan/ARM/{nominal,learned,again}. One run is done twice: the recordings have to be equal bit for bit.
set -euo pipefail
usage() {
    echo "usage: loop_demo.sh DFDYN OUT [--vcan]" >&2
    exit 2
}
[[ $# -eq 2 || ($# -eq 3 && $3 == --vcan) ]] || usage
dfdyn=$(realpath "$1")
out=$(mkdir -p "$2" && cd "$2" && pwd)
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=$root/tests/data
kernel=$root/build/virtual_time/linux.uml

# demo SHOW FOLDER URDF TIP SCENARIO BUS: hyperparameters, then SHOW FOLDER ARM_OPTION...
demo() {
    local folder=$2 urdf=$data/robots/$3 scenario=$data/scenarios/$5
    mkdir -p "$folder"
    sed '/"payloads"/d; s/"seed": /"seed": 1/' "$scenario" >"$folder/commissioning.json"
    "$dfdyn" loop --simulate --robot "$urdf" --scenario "$folder/commissioning.json" --duration 30 -o "$folder/commissioning" >/dev/null
    "$dfdyn" train --robot "$urdf" --tip "$4" --log "$folder/commissioning/nominal.csv" --outputs tau --model SPK \
        --effects viscous_friction,coulomb_friction,rotor_inertia,torque_offset --own-motion --features 60 --forgetting 0.999 \
        --likelihood-rows 500 --starts 4 --refinement 10 -o "$folder/model.json" >"$folder/training.txt"
    "$1" "$folder" --robot "$urdf" --scenario "$scenario" --bus "$data/can/$6"
}
ur5=(ur5/ur5_robot.urdf ee_link ur5_loop.json)
icub=(icub_right_arm/icub_right_arm.urdf r_hand icub_loop.json)

# in_memory FOLDER ARM_OPTION...
in_memory() {
    basename "$1"
    "$dfdyn" loop --simulate "${@:2}" --model "$1/model.json" --from-prior --duration 95.001 -o "$1"
}

# on_vcan FOLDER ARM_OPTION...
on_vcan() {
    local runs=2
    [[ $1 != */ur5 ]] || runs=3 # the faster one shows that it can be repeated
    DFDYN_VIRTUAL_TIME=$kernel DFDYN_VCAN_SECONDS=3600 "$root/tests/vcan/run_vcan_tests.sh" \
        "$root/tools/loop_on_vcan.sh" "$dfdyn" "$1" "$runs" "${@:2}" >"$1/run.txt" 2>&1
}

# One machine per arm, at the same time; the second has another core, where there is one.
both_on_vcan() {
    local first_core pid_icub pid_ur5 status=0
    "$root/tests/vcan/virtual_time/build_kernel.sh" "$(dirname "$kernel")"
    echo "two arms over vcan, 95 s nominal and 95 s learned (the UR5 twice), side by side: some minutes"
    demo on_vcan "$out/vcan/icub" "${icub[@]}" icub_loop.json &
    pid_icub=$!
    first_core=$(taskset --cpu-list --pid $$ | sed -E 's/.*: ([0-9]+).*/\1/')
    (
        taskset --cpu-list --pid "$first_core" "$BASHPID" >/dev/null
        demo on_vcan "$out/vcan/ur5" "${ur5[@]}" ur5_loop.json
    ) &
    pid_ur5=$!
    wait "$pid_ur5" || status=$?
    wait "$pid_icub" || status=$?
    for arm in ur5 icub; do
        echo "$arm"
        cat "$out/vcan/$arm/run.txt"
    done
    return "$status"
}

if [[ $# -eq 3 ]]; then
    both_on_vcan
else
    demo in_memory "$out/ur5" "${ur5[@]}" ur5_loop.json
    demo in_memory "$out/ur5_as_icub" "${ur5[@]}" ur5_icub_loop.json
    demo in_memory "$out/icub" "${icub[@]}" icub_loop.json
fi
