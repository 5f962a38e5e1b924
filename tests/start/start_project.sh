#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# start_project.sh DFDYN host|CORE: runs `dfdyn start` on a part of the TX40's recording with small limits, builds the project that it
# writes for the host or for a bare Cortex-M, and runs it. The project itself compares its predictions with those of `dfdyn`. On a core
# the counted instructions and stack must be within the footprint that `dfdyn` printed.
set -euo pipefail
dfdyn=$1 core=$2
data=$(cd "$(dirname "${BASH_SOURCE[0]}")/../data" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" # the project must not need the repository

# thinned FIRST LAST: every tenth of these rows, 500 Hz.
thinned() { awk -v first="$1" -v last="$2" 'NR == 1 || (NR % 10 == 2 && NR >= first && NR < last)' "$data/tx40_figaroh/tx40_5kHz.csv"; }
thinned 2 15002 >run.csv
again=() robot=()
if [[ $core == host ]]; then
    thinned 15002 37502 >again.csv
    again=(--log again.csv)
    robot=(--robot "$data/robots/tx40/tx40.urdf" --tip tool0)
fi
"$dfdyn" start --log run.csv "${again[@]}" "${robot[@]}" --quick --flash 48K --ram 12K --target "${core/host/cortex-m7}" -o controller >start.txt
grep -q '^chosen: ' start.txt
test -s controller/report.html
test -s controller/model.json

if "$dfdyn" start --log run.csv -o controller 2>refused.txt; then
    echo "dfdyn start overwrote a folder"
    exit 1
fi
grep -q 'controller: expected a new or empty folder, found files in it' refused.txt

if [[ $core == host ]]; then
    "$dfdyn" start --log run.csv "${robot[@]}" --quick --flash 48K --ram 12K -o 'single run' >single.txt
    test -s 'single run/diagnosis.html'
    grep -qF "cmake -S 'single run' -B 'single run/build' && cmake --build 'single run/build' && 'single run/build/replay_ticks'" single.txt
    test -s controller/diagnosis.html
    grep -q '"again.csv"' controller/diagnosis.json # both recordings are one question
    if grep -q 'As an online learner sees it' controller/diagnosis.html; then
        echo "diagnosis.html has a table of learners that were not run"
        exit 1
    fi
    "$dfdyn" footprint --model controller/model.json | grep -q '^smaller models'
    (cd controller && bash -ec "$(grep -m 1 'build/replay_ticks' README.txt)") | tee result.txt
    grep -q 'predictions as of dfdyn replay' result.txt
    exit 0
fi

cmake -S controller -B controller/build -DCMAKE_TOOLCHAIN_FILE=cmake/cortex-m.cmake -DDFDYN_CORE="$core" >/dev/null
cmake --build controller/build --target run 2>&1 | tee result.txt
grep -q 'predictions as of dfdyn replay' result.txt

"$dfdyn" footprint --model controller/model.json --target "$core" --json >footprint.json
figure() { sed -nE "s/.*\"$1\": ([0-9]+).*/\1/p" footprint.json | head -n 1; }
measured() { sed -nE "s/.*$1 ([0-9]+).*/\1/p" result.txt | head -n 1; }
size_fields=$(arm-none-eabi-size controller/build/replay_ticks.elf | tail -n 1)
read -r text data_bytes bss _ <<<"$size_fields"
instructions=$(measured 'instructions of the largest tick') stack=$(measured 'stack')
echo "instructions $instructions of $(figure largest), stack $stack of $(figure stack_bytes)"
echo "the image, with recorded ticks: flash $((text + data_bytes)), RAM without stack $((data_bytes + bss)) of $(figure ram_bytes)"
[[ $instructions -le $(figure largest) ]]
[[ $stack -le $(figure stack_bytes) ]]
[[ $((data_bytes + bss + stack)) -le $(figure ram_bytes) ]]
