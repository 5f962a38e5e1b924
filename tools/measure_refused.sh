#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_refused.sh DFDYN OUT: measures the share of good samples of one run that a model of another run refuses; nobody touched the arm
# in either. Trains NP, P and SPK on runs of the servo and of the UR5, replays the others, and prints a table: the share
# refused, and the normalised error with the gate and without it; then how many refuse less than 0.1 %. Writes models and replays into OUT.
set -euo pipefail
dfdyn=${1:?usage: measure_refused.sh DFDYN OUT}
out=${2:?usage: measure_refused.sh DFDYN OUT}
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/tests/data
mkdir -p "$out"

training=(--outputs i --likelihood-rows 400 --starts 2)
effects=(--effects "viscous_friction,coulomb_friction,rotor_inertia,torque_offset")

# replay MODEL LOG REPLAY
replay() { "$dfdyn" replay --model "$1" --log "$2" --horizon 0 >"$3" 2>&1; }
# Of what a replay printed: the share refused, and the errors.
share() {
    awk '
        / predicted,/ { for (i = 1; i < NF; ++i) if ($(i + 1) == "predicted,") predicted = $i }
        / x innovation_too_large/ { refused = $1 }
        END { printf "%.2f", 100 * refused / predicted }' "$1"
}
errors() { awk '/nRMSE, one step/ { sub(/.*one step */, ""); gsub(/ +/, " "); print }' "$1"; }

# without_gate MODEL: the model with a limit that no sample exceeds.
without_gate() {
    sed -E 's/("innovation": *)[-+.0-9e]+/\11e30/' "$1"
    grep -qE '"innovation": *[-+.0-9e]+' "$1" || {
        echo "$1: expected the number limits.innovation, found none" >&2
        return 1
    }
}

# one STRUCTURE URDF TIP FEATURES A B... : trains on A, replays each B.
one() {
    local model=$1 urdf=$2 tip=$3 features=$4 a=$5 physics=() name b
    shift 5
    [[ $model == NP ]] || physics=(--robot "$data/$urdf" --tip "$tip" "${effects[@]}")
    if [[ $model == P ]]; then
        physics+=(--input DFSR --lags 12)
    else
        physics+=(--features "$features")
    fi
    name=$out/$(basename "$a" .csv).$model
    "$dfdyn" train --log "$a" --model "$model" "${physics[@]}" "${training[@]}" -o "$name.json" >"$name.train" 2>&1
    without_gate "$name.json" >"$name.open.json"
    for b in "$@"; do
        [[ $b != "$a" ]] || continue
        replay "$name.json" "$b" "$name.replay"
        replay "$name.open.json" "$b" "$name.open.replay"
        echo "| $(basename "$a" .csv) | $(basename "$b" .csv) | $model | $(share "$name.replay") | $(errors "$name.replay") | $(errors "$name.open.replay") |"
    done
}

# rows: the table's, of all runs.
rows() {
    local model run
    for model in NP P SPK; do
        for run in 00 03 04 08 12 15; do
            one "$model" xl330_bam/pendulum.urdf arm 50 "$(echo "$data"/xl330_bam/"$run"_*.csv)" "$data"/xl330_bam/*.csv
        done
        for run in No5 No6 No9; do
            one "$model" robots/ur5/ur5_robot.urdf ee_link 100 "$(echo "$data"/ur5_kufieta/Movement_"$run"_*.csv)" \
                "$data"/ur5_kufieta/Movement_{No5_Acc_slow_no_disturbance,No6_Acc_slow_Verify_Model,No7_Acc_slow_Verify_Model_short,No9_Singularity_Free_NoDist}.csv
        done
    done
}

echo "| trained on | replayed | model | good samples refused (%) | nRMSE with the gate | without |"
echo "| --- | --- | --- | ---: | --- | --- |"
rows | tee "$out/rows.md"
awk -F '|' '{ few += $5 < 0.1; if ($5 > most) most = $5 + 0 }
    END { printf "\n%d of %d replays refuse less than 0.1 %%, the others up to %.2f %%\n", few, NR, most }' "$out/rows.md"
