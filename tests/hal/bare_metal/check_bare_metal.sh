#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_bare_metal.sh COMPILER SOURCE INCLUDE...: compiles SOURCE for a Cortex-M7 without an operating system. Fails if
# the object needs external symbols other than memory and arithmetic functions.
set -euo pipefail
compiler=$1 source=$2
shift 2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$compiler" -std=c++20 -mthumb -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16 -O2 -DNDEBUG \
    -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics \
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror \
    "${@/#/-I}" -c "$source" -o "$scratch/object.o"

nm=${compiler%g++}nm
needed=$("$nm" --undefined-only --demangle "$scratch/object.o" | sed 's/^ *[Uw] //')
echo "needs: ${needed//$'\n'/, }"
"${compiler%g++}size" "$scratch/object.o"
if grep -vE '^(mem(cpy|move|set|chr|cmp)|__aeabi_[a-z0-9_]+|l?l?round|sqrt|ldexp|floor)$' <<<"$needed"; then
    echo "check_bare_metal.sh: that is not to be had on bare metal" >&2
    exit 1
fi
