#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# loop_demo.sh DFDYN OUT: a loop that learns the arm it moves, on the simulated UR5 and on the iCub's right arm, over the frames of their
# devices. For each arm: half a minute under the nominal rigid body, without payload, for the hyperparameters; then a minute and a half of
# another motion with friction and a payload that nothing knows of, and a second payload at 65 s, under the nominal rigid body and under a
# model that begins with nothing learned. Prints both tables; writes OUT/ARM/tracking.{csv,svg,html}.
set -euo pipefail
dfdyn=${1:?usage: loop_demo.sh DFDYN OUT}
out=${2:?usage: loop_demo.sh DFDYN OUT}
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/tests/data

# demo ARM URDF TIP SCENARIO BUS
demo() {
    local folder=$out/$1 urdf=$data/robots/$2 scenario=$data/scenarios/$4
    mkdir -p "$folder"
    sed '/"payloads"/d; s/"seed": /"seed": 1/' "$scenario" >"$folder/commissioning.json"
    "$dfdyn" loop --simulate --robot "$urdf" --scenario "$folder/commissioning.json" --duration 30 -o "$folder/commissioning" >/dev/null
    "$dfdyn" train --robot "$urdf" --tip "$3" --log "$folder/commissioning/nominal.csv" --outputs tau --model SPK \
        --effects viscous_friction,coulomb_friction,rotor_inertia,torque_offset --own-motion --features 60 --forgetting 0.999 \
        --likelihood-rows 500 --starts 4 --refinement 10 -o "$folder/model.json" >"$folder/training.txt"
    echo "$1"
    "$dfdyn" loop --simulate --robot "$urdf" --scenario "$scenario" --bus "$data/can/$5" --model "$folder/model.json" --from-prior \
        --duration 95.001 -o "$folder"
}

demo ur5 ur5/ur5_robot.urdf ee_link ur5_loop.json ur5_loop.json
demo ur5_as_icub ur5/ur5_robot.urdf ee_link ur5_loop.json ur5_icub_loop.json
demo icub icub_right_arm/icub_right_arm.urdf r_hand icub_loop.json icub_loop.json
