# shellcheck shell=bash
# SPDX-License-Identifier: Apache-2.0
# loop_models.sh: sourced by loop_demo.sh and measure_loop.sh. How both train the models of a simulated arm.

# commission DFDYN FOLDER URDF SCENARIO: half a minute under the nominal rigid body, on another motion and without payload. Writes
# FOLDER/nominal.csv and its scenario, FOLDER.json. The other loops of the comparison are not needed: no observer.
commission() {
    sed '/"payloads"/d; s/"seed": /"seed": 1/' "$4" >"$2.json"
    "$1" loop --simulate --robot "$3" --scenario "$2.json" --observer-bandwidth 0 --duration 30 -o "$2" >/dev/null
}

# train_model DFDYN FOLDER URDF TIP MODEL OUT: OUT, a model.json, from FOLDER/nominal.csv; the training's summary on standard output.
train_model() {
    "$1" train --robot "$3" --tip "$4" --log "$2/nominal.csv" --outputs tau --model "$5" \
        --effects viscous_friction,coulomb_friction,rotor_inertia,torque_offset --sign-velocity 0.05 --features 60 --forgetting 0.999 \
        --likelihood-rows 500 --starts 4 --refinement 10 -o "$6"
}
