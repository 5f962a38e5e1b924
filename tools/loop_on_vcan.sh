#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# loop_on_vcan.sh DFDYN FOLDER ARM_OPTION... -- [LOOP_OPTION...]: runs an arm (dfdyn plant) and its loop (dfdyn loop) for 95 s as
# two programs on vcan0. Writes their output, the tracking error and the recording into FOLDER. Fails if the loop fails.
set -euo pipefail
dfdyn=$1 folder=$2
shift 2
arm=()
while [[ $1 != -- ]]; do
    arm+=("$1")
    shift
done

mkdir -p "$folder"
"$dfdyn" plant "${arm[@]}" --can vcan0 >"$folder/plant.txt" 2>&1 &
plant=$!
sleep 0.1003 # until it is there; the loop's ticks come between the plant's
"$dfdyn" loop "${arm[@]}" --can vcan0 --duration 97.5 "${@:2}" -o "$folder" >"$folder/loop.txt" 2>&1
kill -INT "$plant"
wait "$plant"
