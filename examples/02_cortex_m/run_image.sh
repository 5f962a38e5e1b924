#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# run_image.sh QEMU BOARD ICOUNT_SHIFT CORE IMAGE.elf prints the flash and RAM of the image and runs it in
# QEMU; the output is also written to IMAGE.txt. Fails if the image contains parts of a heap, exceptions,
# run-time type information, streams, or the sine of the C library.
set -euo pipefail
qemu=$1 board=$2 shift=$3 core=$4 image=$5

size_fields=$(arm-none-eabi-size "$image" | tail -n 1)
read -r text_bytes data_bytes bss_bytes _ <<<"$size_fields"
echo "$core: $(basename "$image" .elf): flash $((text_bytes + data_bytes)) bytes, RAM $((data_bytes + bss_bytes)) bytes (without the stack)"

forbidden='^(_?malloc|_?free|_?calloc|_?realloc|_?sbrk|_?printf|_?vfprintf).*|operator (new|delete)|__cxa_throw|__cxa_allocate_exception|typeinfo for|std::.*(ostream|istream|ios_base)|__gxx_personality|__cxa_guard_acquire|^(sin|cos|sincos)f?$'
symbols=$(arm-none-eabi-nm -C "$image" | cut -d ' ' -f 3-)
if found=$(grep -E "$forbidden" <<<"$symbols"); then
    echo "symbols that firmware must not have:"
    echo "$found"
    exit 1
fi

status=0
"$qemu" -M "$board" -nographic -monitor none -serial none -semihosting-config enable=on,target=native \
    -icount "shift=$shift,sleep=off" -kernel "$image" </dev/null >"${image%.elf}.txt" 2>&1 || status=$?
sed '/^ticks/d' "${image%.elf}.txt"
exit "$status"
