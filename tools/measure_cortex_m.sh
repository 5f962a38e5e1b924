#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_cortex_m.sh: builds the images for every Cortex-M core, with benchmarks of all sizes, runs them under QEMU and
# replaces the table between the marks "cortex-m" of docs/reference/performance.md. The same sources and compiler give the same numbers
# on any machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

page=docs/reference/performance.md
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

for core in cortex-m7 cortex-m7-double cortex-m4f cortex-m55; do
    cmake --preset "$core" -DDFDYN_ALL_BENCHMARKS=ON >/dev/null
    cmake --build --preset "$core" --parallel "$(nproc)" >/dev/null
    ctest --preset "$core" -V --parallel 1 -L cortex_m >"$scratch/$core.txt"
done

# Each image's line of flash and RAM comes before its own.
sed -nE 's/^[0-9]+: (cortex-m[0-9a-z-]+: )/\1/p' "$scratch"/*.txt | awk '
    function after(text) { return substr($0, index($0, text) + length(text)) + 0 }
    function thousands(n) { return n < 1000 ? n "" : thousands(int(n / 1000)) sprintf(",%03d", n % 1000) }
    / flash / { flash = after("flash "); ram = after("RAM ") }
    / benchmark: / {
        sub(/: benchmark/, "")
        learn = after("predict and learn ")
        printf("| %s | %s | %d | %d | %s | %s | %.1f | %s | %s | %s | %d | %d |\n", substr($1, 1, length($1) - 1),
            index($0, ", float") ? "float" : "double", after("joints "), after("columns "), thousands(after("predict ")),
            thousands(learn), 480000 / learn, thousands(flash), thousands(ram), thousands(after("state ")), after("stack "),
            after("stack " after("stack ") " of "))
    }' | sort -t '|' -k2,2r -k3,3r -k4,4n -k5,5n >"$scratch/rows"

{
    sed '/^<!-- cortex-m: written/q' "$page"
    echo "| core | scalar | n | 2d | predict | predict and learn | cycles each may take | flash | RAM | of it state | stack | stack bound |"
    echo "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    cat "$scratch/rows"
    sed -n '/^<!-- cortex-m: end/,$p' "$page"
} >"$scratch/page"
cp "$scratch/page" "$page"
