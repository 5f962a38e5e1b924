#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_unseen.sh [--quick] DFDYN OUT [TRAINING OPTION...]: measures the predictions of models on a motion that they have not learned.
# Trains NP, P and SPK on recording A of an arm, then replays recording B with each and with their combination: frozen (without
# learning), and learning. Prints one table (Markdown) of normalised errors and of shares within two standard deviations, with the
# ratio of the combination to its best member, persistence, AR(2), rigid bodies with friction and a constant. Writes models and replays
# into OUT.
# --quick: only the two recordings that were not used to choose settings of the program.
set -euo pipefail
usage='usage: measure_unseen.sh [--quick] DFDYN OUT [TRAINING OPTION...]'
quick=no
if [[ ${1:-} == --quick ]]; then
    quick=yes
    shift
fi
dfdyn=${1:?$usage}
out=${2:?$usage}
shift 2
training=("$@")
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/tests/data
mkdir -p "$out"

effects=viscous_friction,coulomb_friction,torque_offset
ur5=(--robot "$data/robots/ur5/ur5_robot.urdf" --tip ee_link --outputs i)
tx40=(--robot "$data/robots/tx40/tx40.urdf" --tip tool0 --outputs tau)

# line LABEL ERRORS SHARES: a row of the table, from figures with spaces between them.
line() {
    local figure
    printf '| %-35s |' "$1"
    for figure in $2 $3; do
        printf ' %7s |' "$figure"
    done
    printf '\n'
}

# heading TEXT: a row with a text only.
heading() {
    printf '| %-35s |%s\n' "$1" " | | | | | | | | | | | |"
}

# figures REPLAY LABEL: what `dfdyn replay` printed behind LABEL of its last recording.
figures() {
    awk -v label="$2" 'index($0, "  " label) == 1 { found = substr($0, length(label) + 3) } END { print found }' "$1"
}

# model REPLAY NAME: the row of a model's own predictions.
model() {
    line "$2" "$(figures "$1" "nRMSE, one step")" "$(figures "$1" "share within 2 sigma")"
}

# opponent REPLAY LABEL NAME: the row of an opponent, which has no standard deviations.
opponent() {
    line "$3" "$(figures "$1" "  $2")" "- - - - - -"
}

# ratio NAME KIND: the row of the combination's errors, each divided by its best member's error.
ratio() {
    local structure ratios
    ratios=$(for structure in NP P SPK combination; do
        figures "$out/$1.$structure.$2" "nRMSE, one step"
    done | awk '
        NR < 4 { for (k = 1; k <= NF; ++k) if ($k != "-" && (!(k in best) || $k < best[k])) best[k] = $k }
        NR == 4 { for (k = 1; k <= NF; ++k)
            if ($k == "-" || best[k] + 0 <= 0) printf "- "; else printf "%.3f ", $k / best[k] }')
    line "combination / best member" "$ratios" "- - - - - -"
}

# logged FILE COMMAND...: runs a command with its output in FILE; shows the end of it when the command fails.
logged() {
    local file=$1
    shift
    "$@" >"$file" 2>&1 || {
        tail -n 3 "$file" >&2
        return 1
    }
}

# train_and_replay NAME A ROWS_A B ROWS_B ROBOT...: a model of each structure, and its replays.
train_and_replay() {
    local name=$1 a=$2 rows_a=$3 b=$4 rows_b=$5 structure models=()
    shift 5
    for structure in NP P SPK; do
        local physics=("$@" --effects "$effects")
        [[ $structure != NP ]] || physics=("${@:5}")
        logged "$out/$name.$structure.train" "$dfdyn" train --log "$a" --rows "$rows_a" --model "$structure" \
            "${physics[@]}" "${training[@]}" -o "$out/$name.$structure.json"
        models+=("$out/$name.$structure.json")
    done
    models+=("${models[0]},${models[1]},${models[2]}")
    for structure in NP P SPK combination; do
        local replay=("$dfdyn" replay --model "${models[0]}" --log "$b" --rows "$rows_b" --horizon 0)
        models=("${models[@]:1}")
        logged "$out/$name.$structure.frozen" "${replay[@]}" --frozen
        logged "$out/$name.$structure.learning" "${replay[@]}"
    done
}

# pair NAME TITLE A ROWS_A B ROWS_B ROBOT...: trains on the rows of A, judges on those of B.
pair() {
    local name=$1 title=$2 structure
    shift 2
    train_and_replay "$name" "$@"
    local all=$out/$name.combination
    heading "**$title**"
    heading "*frozen*"
    for structure in NP P SPK combination; do
        model "$out/$name.$structure.frozen" "$structure"
    done
    ratio "$name" frozen
    opponent "$all.frozen" "rigid body of the URDF" "rigid body of the URDF + friction"
    opponent "$all.frozen" "identified rigid body" "identified rigid body + friction"
    line "best constant (by definition)" "1 1 1 1 1 1" "- - - - - -"
    heading "*learning, one step ahead*"
    for structure in NP P SPK combination; do
        model "$out/$name.$structure.learning" "$structure"
    done
    ratio "$name" learning
    opponent "$all.learning" "with residual state" "combination + residual state"
    opponent "$all.learning" "persistence, y(t-1)" "persistence"
    opponent "$all.learning" "AR(2), learned online" "AR(2)"
}

line "nRMSE, then share within 2σ; output" "1 2 3 4 5 6" "2σ:1 2σ:2 2σ:3 2σ:4 2σ:5 2σ:6"
line "---" "---: ---: ---: ---: ---: ---:" "---: ---: ---: ---: ---: ---:"
nist=$data/ur5_nist/halfspeed_payload_0p726kg.csv
tx40_log=$data/tx40_figaroh/tx40_5kHz.csv
pair nist "UR5 at NIST, 42 s, then 21 s" "$nist" :5270 "$nist" 5270: "${ur5[@]}"
pair tx40 "TX40 at 5 kHz, 5 s, then 2.5 s" "$tx40_log" :25000 "$tx40_log" 25000: "${tx40[@]}"
[[ $quick == no ]] || exit 0

kufieta=$data/ur5_kufieta
no6=$kufieta/Movement_No6_Acc_slow_Verify_Model.csv
no5=$kufieta/Movement_No5_Acc_slow_no_disturbance.csv
no9=$kufieta/Movement_No9_Singularity_Free_NoDist.csv
pair no6_no9 "UR5, No6, then No9" "$no6" : "$no9" : "${ur5[@]}"
pair no9_no6 "UR5, No9, then No6" "$no9" : "$no6" : "${ur5[@]}"
pair no6_no5 "UR5, No6, then No5" "$no6" : "$no5" : "${ur5[@]}"
pair no5_no9 "UR5, No5, then No9" "$no5" : "$no9" : "${ur5[@]}"
