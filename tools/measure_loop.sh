#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_loop.sh DFDYN OUT [ARM [FAULT...]]: simulates all faults of a control loop on both arms, prints the tables of docs/results/loop.md. The
# models are those of loop_demo.sh (loop_models.sh), which have learned nothing yet. The faults are those of tests/data/loop_faults, unchanged for the
# UR5 and adapted in size for the iCub's arm. Each table compares the nominal rigid body, an observer, recursive least squares of rigid
# body and friction (model P, a memory of 8 s) without and with observer, the learned model alone, and the complete loop (learned model
# and observer). Takes about 15 minutes; keeps its runs in OUT. ARM (ur5 or icub): only the table of that arm. FAULT (none, or
# a file's name without .json): only these rows.
set -euo pipefail
dfdyn=${1:?usage: measure_loop.sh DFDYN OUT [ARM [FAULT...]]}
out=${2:?usage: measure_loop.sh DFDYN OUT [ARM [FAULT...]]}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=$root/tests/data
# shellcheck source=/dev/null
source "$root/tools/loop_models.sh"
mkdir -p "$out"
faults=("${@:4}")
if [[ ${#faults[@]} -eq 0 ]]; then
    mapfile -t faults < <(echo none && cd "$data/loop_faults" && basename -s .json -- *.json)
fi

# models ARM URDF TIP: OUT/ARM.SPK.json and OUT/ARM.P.json.
models() {
    local arm=$1 robot=$data/robots/$2 model
    commission "$dfdyn" "$out/$arm.commissioning" "$robot" "$data/scenarios/${arm}_loop.json"
    for model in SPK P; do
        train_model "$dfdyn" "$out/$arm.commissioning" "$robot" "$3" "$model" "$out/$arm.$model.json" >"$out/$arm.$model.txt" 2>&1
    done
}

# scenario ARM FAULT: of that arm, with the fault.
scenario() {
    local faulty=$data/loop_faults/$2.json
    if [[ $2 == none ]]; then
        cat "$data/scenarios/$1_loop.json"
    elif [[ $1 == ur5 ]]; then
        cat "$faulty"
    elif [[ $2 == payload_removed ]]; then
        sed -E 's/("centre_m": [^}]*)\}, .*\]/\1, "removed_s": 40}]/' "$data/scenarios/$1_loop.json"
    else
        awk '/"faults"/, /\],$/' "$faulty" | sed 's/20, 20, 0/5, 5, 0/; s/"limit_nm": 40/"limit_nm": 4/' >"$out/faults"
        sed "/\"encoders\"/{
            r $out/faults
            N
        }" "$data/scenarios/$1_loop.json"
    fi
}

# begin_of SCENARIO: time of the first of its faults or of the removal of its payload, s; 0 if it has none after the start.
begin_of() {
    awk '/"faults"/, /\],?$/ { print; next } /"removed_s"/' "$1" | { grep -oE '"(from|at|removed)_s": [0-9.]+' || true; } |
        awk 'NR == 1 || $2 < begin { begin = $2 } END { print begin + 0 }'
}

# cells FAULT BEGIN RUN_OF_SPK RUN_OF_P LIMIT...: a row of the table. Recovery: until the end of the last second before 65 s with more
# than 1.5 times the largest error in the ten seconds before the fault. With ≥ where fewer than five seconds were left to see it.
cells() {
    awk -v fault="$1" -v begin="$2" -v limits="${*:5}" '
        function cell(value) { return value == "" ? "stopped" : sprintf("%.2f", value) }
        BEGIN { split(limits, limit, " ") }
        FNR == 1 { file++ }
        /^ +window \(s\)/ { split("", column); for (i = 3; i <= NF; i++) column[$i] = i - 1 } # of the runs that did not stop
        function of(run) { return run in column ? $column[run] : "" }
        file == 1 && $2 == "loop:" {
            run = $1
            match($0, /\([a-z_]+/)
            ended[run] = substr($0, RSTART + 1, RLENGTH - 1)
        }
        file == 1 && run == "learned" && /^learned: .* s: .*confidence/ {
            cause = $4
            sub(/[:;]$/, "", cause)
            named = named (named == "" ? "" : ", ") cause " " $2 " s"
        }
        file == 1 && $1 == "peaks:" && run == "learned" {
            for (i = 8; $i ~ /^[0-9.]+,?$/; i++) { share = 100 * $i / limit[i - 7]; step = share > step ? share : step }
        }
        /^ +[0-9]+\.[0-9]+ / && $1 >= 10 {
            if (file == 1) {
                for (name in column) { if (of(name) > worst[name]) worst[name] = of(name) }
                if (of("learned") == "") next
                if (of("nominal") != "" && of("learned") / of("nominal") > ratio) ratio = of("learned") / of("nominal")
                if ($1 >= begin - 10 && $1 < begin && of("learned") > usual) usual = of("learned")
                if ($1 >= begin && $1 < 65 && of("learned") > 1.5 * usual) recovered = $1 + 1 - begin
            } else {
                if (of("learned_alone") > least_squares) least_squares = of("learned_alone")
                if (of("learned") > observed) observed = of("learned")
            }
        }
        END {
            printf "| %s | %s | %s | %s | %s | %s | %s | %s | %.1f | %s | %s | %s |\n", fault, cell(worst["nominal"]), cell(worst["observer"]), cell(least_squares),
                cell(observed), cell(worst["learned_alone"]), cell(worst["learned"]), ratio == "" ? "-" : sprintf("%.2f", ratio), step,
                (ended["learned"] == "none" && begin >= 20 ? (begin + recovered > 60 ? "≥ " : "") sprintf("%d", recovered) : "-"), named,
                ended["learned"] == "none" ? "" : ended["learned"]
        }' "$3" "$4"
}

# run ARM URDF FAULT MODEL [OPTION...]: ends with a status where the loop stops by itself, as some shall.
run() {
    "$dfdyn" loop --simulate --robot "$2" --scenario "$out/$1.$3.json" --bus "$data/can/$1_loop.json" \
        --model "$out/$1.$4.json" --from-prior --duration 80 --window 1 "${@:5}" >"$out/$1.$3.$4.run" 2>"$out/$1.$3.$4.error" || [[ $? -eq 1 ]]
}

# table ARM URDF LIMIT...: all faults of an arm.
table() {
    local arm=$1 robot=$data/robots/$2 fault
    echo "| fault | nominal | observer | least squares | least squares, observer | learned alone | learned | learned / nominal | step (%) | recovery (s) | named | stopped by |"
    echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- | --- |"
    for fault in "${faults[@]}"; do
        if [[ $arm == icub && $fault == torque_* ]]; then
            continue # it has no torque sensors
        fi
        scenario "$arm" "$fault" >"$out/$arm.$fault.json"
        run "$arm" "$robot" "$fault" SPK
        run "$arm" "$robot" "$fault" P
        cells "$fault" "$(begin_of "$out/$arm.$fault.json")" "$out/$arm.$fault.SPK.run" "$out/$arm.$fault.P.run" "${@:3}"
    done
}

if [[ ${3:-ur5} == ur5 ]]; then
    models ur5 ur5/ur5_robot.urdf ee_link
    echo "UR5, 500 Hz, CiA 402 with SYNC: worst second, mrad"
    echo
    table ur5 ur5/ur5_robot.urdf 150 150 150 28 28 28
    echo
fi
if [[ ${3:-icub} == icub ]]; then
    models icub icub_right_arm/icub_right_arm.urdf r_hand
    echo "iCub's arm, 1 kHz, strain F/T: worst second, mrad"
    echo
    table icub icub_right_arm/icub_right_arm.urdf 30 30 15 15
fi
