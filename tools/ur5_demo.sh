#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# ur5_demo.sh DFDYN OUT [TRAINING OPTION...]: the demo's work, without building: hyperparameters from the first third of a UR5 recording (positions and
# motor currents), then learning from nothing, tick by tick, over the whole of it and two further recordings, in the second of
# which a person pushes the arm. Writes model.json, model.hpp, replay.csv and report.html into OUT.
set -euo pipefail
dfdyn=${1:?usage: ur5_demo.sh DFDYN OUT}
out=${2:?usage: ur5_demo.sh DFDYN OUT}
shift 2
recordings=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/tests/data/ur5_kufieta
slow=$recordings/Movement_No6_Acc_slow_Verify_Model.csv
short=$recordings/Movement_No7_Acc_slow_Verify_Model_short.csv
pushed=$recordings/Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv

mkdir -p "$out"
"$dfdyn" train --log "$slow" --rows :3421 --outputs i --model NP --hyper ML \
    --input DFR --lags 30 --features-per-joint 4 --features 400 --forgetting 0.9999 \
    --likelihood-rows 800 --starts 2 --refinement 60 "$@" -o "$out/model.json" --header "$out/model.hpp"
"$dfdyn" replay --model "$out/model.json" --from-prior --log "$slow,$short,$pushed" \
    -o "$out/replay.csv" --report "$out/report.html"
