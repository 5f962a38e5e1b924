#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# measure_host.sh [PASSES]: builds dfdyn for this machine, runs `dfdyn bench` and replaces the tables between the marks "host" of
# docs/reference/performance.md, and its picture. Takes about 20 minutes, 10 of them for the loop. A busy machine needs more passes.
# Libraries from Debian are measured if they are installed: libqrupdate-dev, libdlib-dev, and libopenblas-serial-dev for BLAS.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

page=docs/reference/performance.md
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target dfdyn >/dev/null
build/release/tools/dfdyn bench --hour --stretch 3600000 --passes "${1:-60}" --loop 600 --output "$scratch/bench" >/dev/null

{
    sed '/^<!-- host: written/q' "$page"
    cat "$scratch/bench/bench.md"
    sed -n '/^<!-- host: end/,$p' "$page"
} >"$scratch/page"
cp "$scratch/page" "$page"
mkdir -p docs/reference/pictures
cp "$scratch"/bench/pictures/*.svg docs/reference/pictures/
