#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# heap_does_not_link.sh COMPILER IMAGE_FOLDER: an image links unchanged, but not with a heap or exceptions, even if the system
# calls that these need are supplied.
set -euo pipefail
compiler=$1 images=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

flags=(-std=c++20 -mthumb -mcpu=cortex-m7 -mfpu=fpv5-sp-d16 -mfloat-abi=hard -O2 "-I$images" '-DDFDYN_CORE="cortex-m7"')
for part in startup semihosting; do
    "$compiler" "${flags[@]}" -fno-exceptions -fno-rtti -c "$images/$part.cpp" -o "$scratch/$part.o"
done

# link NAME: links an image of the program on standard input.
link() {
    cat >"$scratch/$1.cpp"
    "$compiler" "${flags[@]}" "$scratch/$1.cpp" "$scratch/startup.o" "$scratch/semihosting.o" -nostartfiles "-T$images/image.ld" \
        -Wl,--gc-sections --specs=nosys.specs -o "$scratch/$1.elf" 2>"$scratch/$1.txt"
}

# refused NAME MESSAGE: checks that the program on standard input does not link, with this message.
refused() {
    if link "$1"; then
        echo "an image with $1 links"
        exit 1
    fi
    if ! grep -F "$2" "$scratch/$1.txt"; then
        echo "an image with $1 does not link, but not because '$2':"
        cat "$scratch/$1.txt"
        exit 1
    fi
}

if ! link nothing <<<'int application() { return 0; }'; then
    cat "$scratch/nothing.txt"
    exit 1
fi
refused malloc "the image has malloc" <<'EOF'
#include <cstdlib>
void* volatile kept;
int application() { kept = std::malloc(8); return 0; }
EOF
refused new "the image has operator new or delete" <<'EOF'
int* volatile kept;
void* operator new(unsigned size) { static char room[64]; return size <= 64 ? room : nullptr; }
int application() { kept = new int(1); return 0; }
EOF
refused throw "the image has an unwinder" <<'EOF'
int application() { throw 1; }
EOF
