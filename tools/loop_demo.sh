#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# loop_demo.sh DFDYN OUT [--vcan]: a loop that learns the arm that it moves: the simulated UR5 and the iCub's right arm, with the
# frames of their devices. For each arm, the hyperparameters come from half a minute with the nominal rigid body and without payload.
# Then another motion of a minute and a half has unknown friction, an unknown payload and a second payload from 65 s. It runs with the
# nominal rigid body, and with a model that has learned nothing yet. Prints the tables; without --vcan also those of recursive least
# squares of rigid body and friction (model P, a memory of 8 s), without and with observer.
# Without --vcan: simulated time, frames in memory, one minute; writes OUT/ARM/tracking.{csv,svg,html} and recordings.
# With --vcan: arm and loop are two programs on a virtual CAN interface, at the devices' rates. They run in a user-mode Linux whose clock
# stops while programs run, one machine per run: about 6 minutes on two cores, and 5 for that kernel the first time (build/virtual_time).
# Errors are those of measured positions; writes OUT/vcan/ARM/{nominal,learned,again}. One run is repeated: both recordings must be equal.
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
# shellcheck source=/dev/null
source "$root/tools/loop_models.sh"
kernel=$root/build/virtual_time/linux.uml
cores=$(taskset --cpu-list --pid $$ | sed -E 's/.*: //') # that we may use
first_core=${cores%%[,-]*}
last_core=${cores##*[,-]}

# hyperparameters MODEL FOLDER URDF TIP: FOLDER/MODEL.json, from the commissioning motion.
hyperparameters() {
    train_model "$dfdyn" "$2/commissioning" "$3" "$4" "$1" "$2/$1.json" >"$2/$1.txt"
}

# demo SHOW FOLDER URDF TIP SCENARIO BUS: hyperparameters, then SHOW FOLDER ARM_OPTION...
demo() {
    local folder=$2 urdf=$data/robots/$3 tip=$4 scenario=$data/scenarios/$5
    mkdir -p "$folder"
    commission "$dfdyn" "$folder/commissioning" "$urdf" "$scenario"
    hyperparameters SPK "$folder" "$urdf" "$tip"
    "$1" "$folder" --robot "$urdf" --scenario "$scenario" --bus "$data/can/$6"
}
ur5=(ur5/ur5_robot.urdf ee_link ur5_loop.json)
icub=(icub_right_arm/icub_right_arm.urdf r_hand icub_loop.json)

# in_memory FOLDER ARM_OPTION...
in_memory() {
    local loop=("$dfdyn" loop --simulate "${@:2}" --from-prior --duration 95)
    basename "$1"
    "${loop[@]}" --model "$1/SPK.json" -o "$1"
    hyperparameters P "$1" "$3" "$tip"
    "${loop[@]}" --model "$1/P.json" -o "$1/least_squares" >/dev/null
    awk -F, 'BEGIN { print "beside recursive least squares, mrad\n  window (s)  least squares  with observer  learned" }
        NR == FNR { least_squares[$1, $2] = $4; next }
        $1 == "learned" {
            printf "%6d to %2d%15.2f%15.2f%9.2f\n", $2, $3, least_squares["learned_alone", $2], least_squares["learned", $2], $4
        }' "$1/least_squares/tracking.csv" "$1/tracking.csv"
}

# one_run CORE FOLDER ARM_OPTION... -- [LOOP_OPTION...]: in a machine of its own, on that core.
one_run() {
    DFDYN_VIRTUAL_TIME=$kernel DFDYN_VCAN_SECONDS=3600 taskset --cpu-list "$1" "$root/tests/vcan/run_vcan_tests.sh" \
        "$root/tools/loop_on_vcan.sh" "$dfdyn" "${@:2}" >"$2.console" 2>&1 || {
        cat "$2.console" "$2/loop.txt" "$2/plant.txt" >&2
        return 1
    }
}

# on_vcan FOLDER ARM_OPTION...: nominal on one core, learned on another, where there is one.
on_vcan() {
    local folder=$1 nominal
    local learned=(--model "$folder/SPK.json" --from-prior)
    one_run "$first_core" "$folder/nominal" "${@:2}" -- --observer-bandwidth 0 &
    nominal=$!
    one_run "$last_core" "$folder/learned" "${@:2}" -- "${learned[@]}"
    wait "$nominal"
    basename "$folder"
    for run in nominal learned; do
        echo "$run:"
        grep --no-filename -E '^(note|loop|learning|bus|pace|plant):' "$folder/$run/loop.txt" "$folder/$run/plant.txt" | sed 's/^/    /'
    done
    compare "$folder/nominal/tracking.csv" "$folder/learned/tracking.csv"
}

# compare TRACKING TRACKING: fails unless the second has a third of the error from 60 to 65 s, and never a larger one.
compare() {
    awk -F, 'BEGIN { print "tracking error, root mean square over all joints, mrad\n  window (s)  nominal  learned    ratio"; least = 1e9 }
        FNR == 1 { next }
        NR == FNR { nominal[$2] = $4; next }
        { ratio[$2] = nominal[$2] / $4; least = ratio[$2] < least ? ratio[$2] : least
          printf "%6d to %2d%9.2f%9.2f%9.1f\n", $2, $3, nominal[$2], $4, ratio[$2] }
        END { printf "%.1f times less from 60 to 65 s, at least %.1f times at any time\n", ratio[60], least
              exit !(FNR == 20 && ratio[60] >= 3 && least >= 1) }' "$@"
}

# again FOLDER ARM_OPTION...: the learned run once more has to give the same recording, bit for bit.
again() {
    local sum
    one_run "$last_core" "$1/again" "${@:2}" -- --model "$1/SPK.json" --from-prior
    sum=$(sha256sum <"$1/learned/learned.csv")
    if [[ $(sha256sum <"$1/again/learned.csv") != "$sum" ]]; then
        echo "the second learned run gave another recording" >&2
        return 1
    fi
    echo "the second learned run gave the same recording, sha256 ${sum%% *}"
}

on_vcan_twice() {
    on_vcan "$@"
    again "$@"
}

if [[ $# -eq 3 ]]; then
    "$root/tests/vcan/virtual_time/build_kernel.sh" "$(dirname "$kernel")"
    demo on_vcan_twice "$out/vcan/ur5" "${ur5[@]}" ur5_loop.json
    demo on_vcan "$out/vcan/icub" "${icub[@]}" icub_loop.json
else
    demo in_memory "$out/ur5" "${ur5[@]}" ur5_loop.json
    demo in_memory "$out/ur5_as_icub" "${ur5[@]}" ur5_icub_loop.json
    demo in_memory "$out/icub" "${icub[@]}" icub_loop.json
fi
