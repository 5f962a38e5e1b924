#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# newcomer.sh [--full] DFDYN [NAME...]: goes from three recordings, which the demo and the tutorial do not use, or from those NAMEs, to a
# controller that runs under QEMU. Prints the time and the number of commands for each; both are limited to ten minutes and four commands.
# --full searches as long as `dfdyn start` does by itself. INSTALL in the environment is a command that installs the program: it runs
# first and counts.
set -euo pipefail
search=(--quick)
if [[ ${1:-} == --full ]]; then
    search=()
    shift
fi
dfdyn=$1
shift
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/../data" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# Two arms and three sample rates; the second arm has no robot file.
declare -A options=(
    [ur5_nist]="--log $data/ur5_nist/halfspeed_payload_0p726kg.csv --robot $data/robots/ur5/ur5_robot.urdf --tip ee_link"
    [xl330]="--log $data/xl330_bam/07_sin_time_square_kp200.csv"
    [ur5_singularity_free]="--log $data/ur5_kufieta/Movement_No9_Singularity_Free_NoDist.csv --robot $data/robots/ur5/ur5_robot.urdf --tip ee_link"
)
names=("$@")
[[ ${#names[@]} -gt 0 ]] || names=("${!options[@]}")

for name in "${names[@]}"; do
    commands=0 begin=$SECONDS
    run() {
        local start=$SECONDS
        commands=$((commands + 1))
        "$@" >>"$name.txt" 2>&1 || {
            tail -n 30 "$name.txt"
            echo "$name: failed: $*"
            exit 1
        }
        echo "$name: $((SECONDS - start)) s: $*"
    }
    read -ra install <<<"${INSTALL:-}"
    [[ ${#install[@]} -eq 0 ]] || run "${install[@]}"
    read -ra words <<<"${options[$name]}"
    run "$dfdyn" start "${words[@]}" "${search[@]}" -o "$name"
    run cmake -S "$name" -B "$name/build" -DCMAKE_TOOLCHAIN_FILE=cmake/cortex-m.cmake -DDFDYN_CORE=cortex-m7
    run cmake --build "$name/build" --target run
    grep -q '^predictions as of dfdyn replay' "$name.txt"
    if [[ ${options[$name]} == *--robot* ]]; then
        test -s "$name/diagnosis.html"
        grep -q 'the robot with the causes found: nRMSE' "$name.txt" # the diagnosis answered
    fi
    seconds=$((SECONDS - begin))
    echo "$name: $commands commands, $((seconds / 60)) min $((seconds % 60)) s"
    [[ $commands -le 4 && $seconds -le 600 ]]
done
