#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_realtime.sh SOURCE_FOLDER FAMILIES: checks that functions within the control loop's period do not block, with clang's
# function effects at compile time and RealtimeSanitizer at run time, and that both detect a function that blocks. FAMILIES is the
# folder of every_family.hpp. Needs clang 20 or later with its runtime; without it the script reports that and checks nothing.
set -euo pipefail
cd "$1"
families=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

compiler=
for version in 23 22 21 20; do
    if command -v "clang++-$version" >/dev/null; then
        compiler=clang++-$version
        break
    fi
done
if [[ -z $compiler ]] || ! "$compiler" -fsanitize=realtime -x c++ - -o "$scratch/any" <<<'int main() {}' 2>/dev/null; then
    echo "realtime: NOT CHECKED: no clang with RealtimeSanitizer (Debian 12: apt-get install clang-22 libclang-rt-22-dev)"
    exit 77 # skipped
fi

awk -v table=samples -f examples/ur5/ur5_tables.awk tests/data/ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv >"$scratch/ur5_samples.hpp"
compile=("$compiler" -std=c++20 -O1 -Wfunction-effects -Werror=function-effects -fsanitize=realtime -DNDEBUG
    -I. "-I$scratch" "-I$families" -Ifirmware_lib/include -Ihal/include tests/realtime/realtime.cpp)
if "${compile[@]}" -DDFDYN_MUST_NOT_COMPILE -fsyntax-only 2>"$scratch/refused.txt"; then
    echo "realtime: a function that may not block allocates, and compiles"
    exit 1
fi
grep -q "error: function with 'nonblocking' attribute must not call non-'nonblocking' function '.*allocate" "$scratch/refused.txt"
"${compile[@]}" -o "$scratch/realtime"
"$scratch/realtime"
if "$scratch/realtime" block 2>"$scratch/caught.txt"; then
    echo "realtime: an allocation within the period was not caught"
    exit 1
fi
grep -q 'RealtimeSanitizer.*unsafe-library-call' "$scratch/caught.txt"
echo "realtime: checked by $compiler: effects of functions, and RealtimeSanitizer"
