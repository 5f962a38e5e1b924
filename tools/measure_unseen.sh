#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_unseen.sh [--quick] DFDYN OUT [TRAINING OPTION...]: how well a model that learned one motion predicts another of the same arm, which it has not seen
# and does not learn. Trains NP, P and SPK on recording A, replays recording B frozen with each and with their combination, and
# prints a table of the normalised errors and of the shares within two standard deviations. Writes models and replays into OUT.
# --quick: only the two recordings that chose no setting of the program.
set -euo pipefail
quick=no
if [[ ${1:-} == --quick ]]; then
    quick=yes
    shift
fi
dfdyn=${1:?usage: measure_unseen.sh [--quick] DFDYN OUT [TRAINING OPTION...]}
out=${2:?usage: measure_unseen.sh [--quick] DFDYN OUT [TRAINING OPTION...]}
shift 2
training=("$@")
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/tests/data
mkdir -p "$out"

effects=viscous_friction,coulomb_friction,torque_offset
ur5=(--robot "$data/robots/ur5/ur5_robot.urdf" --tip ee_link --outputs i)
tx40=(--robot "$data/robots/tx40/tx40.urdf" --tip tool0 --outputs tau)

# figures REPLAY LABEL: a line of the table from what `dfdyn replay` printed of its last recording.
figures() {
    awk -v label="$2" '
        /nRMSE, one step/ { sub(/.*one step */, ""); error = $0 }
        /share within 2 sigma/ { sub(/.*sigma */, ""); share = $0 }
        END {
            gsub(/ +/, " | ", error)
            gsub(/ +/, " | ", share)
            printf "| %s | %s | %s |\n", label, error, share
        }' "$1"
}

# pair NAME TITLE A ROWS_A B ROWS_B ROBOT...: trains on the rows of A, judges on those of B.
pair() {
    local name=$1 title=$2 a=$3 rows_a=$4 b=$5 rows_b=$6 model
    shift 6
    echo
    echo "$title"
    echo
    echo "| | nRMSE, output 1 | 2 | 3 | 4 | 5 | 6 | within 2σ, output 1 | 2 | 3 | 4 | 5 | 6 |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    for model in NP P SPK; do
        local physics=("$@")
        if [[ $model == NP ]]; then
            physics=("${@:5}")
        else
            physics+=(--effects "$effects")
        fi
        "$dfdyn" train --log "$a" --rows "$rows_a" --model "$model" "${physics[@]}" "${training[@]}" \
            -o "$out/$name.$model.json" >"$out/$name.$model.train" 2>&1
        "$dfdyn" replay --frozen --model "$out/$name.$model.json" --log "$b" --rows "$rows_b" --horizon 0 \
            >"$out/$name.$model.replay" 2>&1
        figures "$out/$name.$model.replay" "$model"
    done
    "$dfdyn" replay --frozen --model "$out/$name.NP.json,$out/$name.P.json,$out/$name.SPK.json" --log "$b" --rows "$rows_b" \
        --horizon 0 >"$out/$name.combination.replay" 2>&1
    figures "$out/$name.combination.replay" "combination"
}

nist=$data/ur5_nist/halfspeed_payload_0p726kg.csv
tx40_log=$data/tx40_figaroh/tx40_5kHz.csv
pair nist "UR5 of another laboratory, its first 42 s, then its last 21 s" "$nist" :5270 "$nist" 5270: "${ur5[@]}"
pair tx40 "TX40 at 5 kHz, its first 5 s, then the rest" "$tx40_log" :25000 "$tx40_log" 25000: "${tx40[@]}"
[[ $quick == no ]] || exit 0

kufieta=$data/ur5_kufieta
no6=$kufieta/Movement_No6_Acc_slow_Verify_Model.csv
no5=$kufieta/Movement_No5_Acc_slow_no_disturbance.csv
no9=$kufieta/Movement_No9_Singularity_Free_NoDist.csv
pair no6_no9 "UR5, No6, then No9" "$no6" : "$no9" : "${ur5[@]}"
pair no9_no6 "UR5, No9, then No6" "$no9" : "$no6" : "${ur5[@]}"
pair no6_no5 "UR5, No6, then No5" "$no6" : "$no5" : "${ur5[@]}"
pair no5_no9 "UR5, No5, then No9" "$no5" : "$no9" : "${ur5[@]}"
