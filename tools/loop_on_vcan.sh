#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# loop_on_vcan.sh DFDYN FOLDER RUNS ARM_OPTION...: where there is vcan0, 95 s of an arm (dfdyn plant) and its loop (dfdyn loop) as two
# programs on it: under the nominal rigid body, and under FOLDER/model.json that begins with nothing learned; RUNS 3: this a second
# time. Prints what they say and the tracking error of both. Fails where a loop did, where the learned one's error is not a third of the
# nominal one's from 60 to 65 s, or is larger at any time, and where the second time gives another recording.
set -euo pipefail
dfdyn=$1 folder=$2 runs=$3 arm=("${@:4}")

# run NAME [LOOP_OPTION...]
run() {
    local plant log=$folder/$1
    mkdir -p "$log"
    "$dfdyn" plant "${arm[@]}" --can vcan0 >"$log/plant.txt" 2>&1 &
    plant=$!
    sleep 0.1003 # until it is there; the loop's ticks come between the plant's
    "$dfdyn" loop "${arm[@]}" --can vcan0 --duration 97.5 "${@:2}" -o "$log" >"$log/loop.txt" 2>&1 || {
        cat "$log/loop.txt"
        return 1
    }
    kill -INT "$plant"
    wait "$plant"
    echo "$1:"
    grep --no-filename -E '^(note|loop|learning|bus|pace|plant):' "$log/loop.txt" "$log/plant.txt" | sed 's/^/    /'
}

# compare TRACKING TRACKING
compare() {
    awk -F, 'BEGIN { print "tracking error, root mean square over all joints, mrad\n  window (s)  nominal  learned    ratio"; least = 1e9 }
        FNR == 1 { next }
        NR == FNR { nominal[$2] = $4; next }
        { ratio[$2] = nominal[$2] / $4; least = ratio[$2] < least ? ratio[$2] : least
          printf "%6d to %2d%9.2f%9.2f%9.1f\n", $2, $3, nominal[$2], $4, ratio[$2] }
        END { printf "%.1f times less from 60 to 65 s, at least %.1f times at any time\n", ratio[60], least
              exit !(FNR == 20 && ratio[60] >= 3 && least >= 1) }' "$@"
}

learned=(--model "$folder/model.json" --from-prior)
run nominal
run learned "${learned[@]}"
compare "$folder/nominal/tracking.csv" "$folder/learned/tracking.csv"
[[ $runs -eq 3 ]] || exit 0
run again "${learned[@]}"
sum=$(sha256sum <"$folder/learned/learned.csv")
if [[ $(sha256sum <"$folder/again/learned.csv") != "$sum" ]]; then
    echo "the second run of the learned one gave another recording" >&2
    exit 1
fi
echo "the second run of the learned one gave the same recording, sha256 ${sum%% *}"
