#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes ur5_model.hpp from the recording in tests/data.
# Usage: make_ur5_model.sh PATH_TO_DFDYN
set -euo pipefail
dfdyn=${1:?usage: make_ur5_model.sh PATH_TO_DFDYN}
here=$(cd "$(dirname "$0")" && pwd)
log=$here/../../tests/data/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$dfdyn" train --log "$log" --rows :3421 --outputs i --input DFR --lags 10 --features 50 \
    --likelihood-rows 600 --starts 2 -o "$scratch/model.json" --header "$here/ur5_model.hpp"
