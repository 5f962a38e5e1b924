#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes ur5_model.hpp, ur5_samples.hpp and ur5_frames.hpp from the recording in tests/data.
# Usage: make_ur5_headers.sh PATH_TO_DFDYN
set -euo pipefail
dfdyn=${1:?usage: make_ur5_headers.sh PATH_TO_DFDYN}
here=$(cd "$(dirname "$0")" && pwd)
log=$here/../../tests/data/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$dfdyn" train --log "$log" --rows :3421 --outputs i --input DFR --lags 10 --features 50 \
    --likelihood-rows 600 --starts 2 -o "$scratch/model.json" --header "$here/ur5_model.hpp"

# Rows 5200 to 5499: time in microseconds, six positions, six currents.
awk -F, '
    NR == 1 {
        print "// SPDX-License-Identifier: Apache-2.0"
        print "// Written by make_ur5_headers.sh: 2.4 s of a UR5 in motion (provenance: tests/data/ur5_kufieta)."
        print "// clang-format off\n#pragma once\n\n#include <cstdint>\n"
        print "struct Ur5Sample {\n    std::int64_t time_us;\n    float position_rad[6];\n    float current_A[6];\n};\n"
        print "inline constexpr Ur5Sample ur5_samples[] = {"
    }
    NR >= 5202 && NR < 5502 {
        printf "    {%d, {%sF, %sF, %sF, %sF, %sF, %sF}, {%sF, %sF, %sF, %sF, %sF, %sF}},\n",
            $1 * 1000000 + 0.5, $2, $3, $4, $5, $6, $7, $14, $15, $16, $17, $18, $19
    }
    END { print "};" }' "$log" > "$here/ur5_samples.hpp"

# The same rows as frames of six CiA 402 drives.
awk 'NR == 1 || NR >= 5202 && NR < 5502' "$log" > "$scratch/rows.csv"
"$dfdyn" convert --log "$scratch/rows.csv" --bus "$here/../../tests/data/can/ur5_cia402.json" -o "$scratch/frames.log"
awk '
    BEGIN {
        print "// SPDX-License-Identifier: Apache-2.0"
        print "// Written by make_ur5_headers.sh: the samples of ur5_samples.hpp as frames of CiA 402 drives (tests/data/can/ur5_cia402.json)."
        print "// clang-format off\n#pragma once\n\n#include <cstdint>\n"
        print "struct Ur5Frame {\n    std::uint32_t time_us;\n    std::uint16_t id;\n    std::uint8_t length;\n    std::uint8_t data[8];\n};\n"
        print "inline constexpr Ur5Frame ur5_frames[] = {"
    }
    {
        split($3, frame, "#")
        split(substr($1, 2, length($1) - 2), time, ".")
        printf "    {%d, 0x%s, %d, {", time[1] * 1000000 + substr(time[2], 1, 6), frame[1], length(frame[2]) / 2
        for (i = 1; i < length(frame[2]); i += 2) printf("%s0x%s", (i > 1 ? ", " : ""), substr(frame[2], i, 2))
        print "}},"
    }
    END { print "};" }' "$scratch/frames.log" > "$here/ur5_frames.hpp"
