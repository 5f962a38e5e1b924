#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# check.sh PROGRAM: fails if PROGRAM does not run, or needs a library of the learners that only the benchmarks compare with.
set -eu
"$1" > /dev/null
needed=$(readelf --dynamic --wide "$1" | grep NEEDED)
if printf '%s\n' "$needed" | grep -Ei 'blas|lapack|qrupdate'; then
    echo "the rooms of the program need a library of the benchmarks" >&2
    exit 1
fi
