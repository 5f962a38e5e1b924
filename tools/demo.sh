#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# demo.sh: installs missing packages, builds dfdyn and learns a UR5's motor currents from joint positions in one recording. Replays
# further recordings through the estimator that would run on the robot. Then trains on one part of two recordings that chose no setting
# of the program, and prints the prediction errors of the rest, together with those of simple predictors. Writes into build/demo.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

dfdyn=build/release/tools/dfdyn
out=build/demo
step_count=4

step() {
    echo
    echo "[$1/$step_count, ${SECONDS} s] $2"
}

build_program() {
    cmake --preset release -DDFDYN_BUILD_TESTS=OFF >build/demo/configure.log || {
        cat build/demo/configure.log
        return 1
    }
    cmake --build --preset release --parallel "$(nproc)" --target dfdyn
}

mkdir -p "$out"
step 1 "packages"
tools/install_packages.sh demo
step 2 "build"
build_program
step 3 "learn from a recording, then replay recordings tick by tick"
tools/ur5_demo.sh "$dfdyn" "$out"
step 4 "two robots that chose no setting: learn one part, predict the rest"
# Fewer rows and starts than by default, for time alone.
tools/measure_unseen.sh --quick "$dfdyn" "$out/unseen" --likelihood-rows 300 --starts 2 --refinement 20 |
    tee "$out/unseen.md"

echo
echo "Done in $SECONDS s:"
echo "  $out/report.html  open it in a browser"
echo "  $out/replay.csv   measured, predicted and standard deviation per tick (PlotJuggler, pandas)"
echo "  $out/unseen.md    the table above"
echo "  $out/model.json   what was learned"
echo "  $out/model.hpp    the same for the firmware"
