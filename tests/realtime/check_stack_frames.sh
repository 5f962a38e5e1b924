#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_stack_frames.sh CEILING_BYTES OBJECT...: fails when a function of these objects, compiled with -fstack-usage, has a
# frame above the ceiling or of a size that is not known at compile time. Prints the largest frame.
set -euo pipefail

ceiling_bytes=$1
shift
usage_files=()
for object in "$@"; do
    usage_files+=("${object%.*}.su")
done

awk -F '\t' -v ceiling="$ceiling_bytes" '
    NF != 3                  { print "not a line of stack usage: " $0; bad = 1; next }
    $3 == "dynamic"          { print "frame of unknown size: " $1; bad = 1 }
    $2 + 0 > ceiling + 0     { print "frame of " $2 " bytes, above the ceiling of " ceiling ": " $1; bad = 1 }
    $2 + 0 >= largest + 0    { largest = $2; where = $1 }
    END {
        if (NR == 0) { print "no function found"; exit 1 }
        print "largest frame: " largest " bytes of " ceiling ", " where
        exit bad
    }' "${usage_files[@]}"
