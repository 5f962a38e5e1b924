#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes ur5_model.hpp and ur5_samples.hpp anew, from the recording that the project carries.
# Usage: make_ur5_headers.sh PATH_TO_DFDYN
set -euo pipefail
dfdyn=${1:?usage: make_ur5_headers.sh PATH_TO_DFDYN}
here=$(cd "$(dirname "$0")" && pwd)
log=$here/../../tests/data/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv

model=$(mktemp)
trap 'rm -f "$model"' EXIT
"$dfdyn" train --log "$log" --rows :3421 --outputs i --input DFR --lags 10 --features 50 \
    --likelihood-rows 600 --starts 2 -o "$model" --header "$here/ur5_model.hpp"

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
