#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clean_root.sh [PACKAGES]: makes a Debian root with nothing but the base system for each of the newcomer's three recordings, installs the
# program there from its .deb, and lets tests/start/newcomer.sh go on without --quick. Needs root rights, debootstrap and a mirror: the one
# that apt of this machine uses. PACKAGES: folder with the packages; by default they are built with the preset `package`.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=${1:-}

if [[ $(id -u) -ne 0 ]] || ! command -v debootstrap >/dev/null || ! command -v objdump >/dev/null; then
    echo "not run: needs root rights, debootstrap and objdump"
    exit 77
fi
mirror=$(sed -nE 's/^URIs: *(\S+).*/\1/p; s/^deb (\[[^]]*\] )?(\S+) bookworm .*/\2/p' \
    /etc/apt/sources.list /etc/apt/sources.list.d/debian.* 2>/dev/null | head -n 1 || true)
if [[ -z $mirror ]]; then
    echo "not run: apt of this machine names no mirror of Debian 12"
    exit 77
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

if [[ -z $packages ]]; then
    (cd "$source" && cmake --preset package && cmake --build --preset package --parallel "$(nproc)") >"$scratch/build.log" || {
        tail -n 30 "$scratch/build.log"
        exit 1
    }
    packages=$scratch/packages
    cpack --config "$source/build/package/CPackConfig.cmake" -B "$packages" >/dev/null
fi
program=$(find "$packages" -maxdepth 1 -name 'dfdyn_*_amd64.deb')
library=$(find "$packages" -maxdepth 1 -name 'libdfdyn-dev_*_amd64.deb')

# The program runs on every x86-64-v2 processor: no instruction uses the wide registers or the encoding of AVX.
dpkg-deb -x "$program" "$scratch/unpacked"
objdump -d --no-show-raw-insn "$scratch/unpacked/usr/bin/dfdyn" >"$scratch/instructions"
avx=$(grep -cE '%[yz]mm[0-9]|	v[a-z0-9]+ .*%xmm' "$scratch/instructions" || true)
echo "instructions beyond x86-64-v2: $avx"
[[ $avx -eq 0 ]]

debootstrap --variant=minbase bookworm "$scratch/base" "$mirror" >"$scratch/debootstrap.log" || {
    tail -n 20 "$scratch/debootstrap.log"
    exit 1
}
mkdir "$scratch/base/newcomer"
cp "$program" "$scratch/base/newcomer/dfdyn.deb"
cp "$library" "$scratch/base/newcomer/libdfdyn-dev.deb"
cp -r "$source/tests/start" "$source/tests/packaging" "$scratch/base/newcomer"
mkdir "$scratch/base/newcomer/data"
cp -r "$source"/tests/data/{ur5_nist,xl330_bam,ur5_kufieta,robots} "$scratch/base/newcomer/data"
chroot "$scratch/base" apt-get update >/dev/null

# inside ROOT COMMAND...
inside() {
    local root=$1
    shift
    chroot "$root" env -i PATH=/usr/bin:/usr/sbin:/bin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
}

# What the program needs beyond its dependencies to build for a Cortex-M and to run it: its package suggests them.
tools="cmake make g++ gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm"
for name in ur5_nist xl330 ur5_singularity_free; do
    cp -a "$scratch/base" "$scratch/root"
    inside "$scratch/root" INSTALL="apt-get install --yes --no-install-recommends /newcomer/dfdyn.deb $tools" \
        /newcomer/start/newcomer.sh --full /usr/bin/dfdyn "$name"
    if [[ $name == xl330 ]]; then # the library, by CMake and by pkg-config
        inside "$scratch/root" apt-get install --yes --no-install-recommends /newcomer/libdfdyn-dev.deb pkg-config >/dev/null
        read -ra flags <<<"$(inside "$scratch/root" pkg-config --cflags dfdyn)"
        inside "$scratch/root" c++ -std=c++20 "${flags[@]}" -fsyntax-only /newcomer/packaging/consumer.cpp
        inside "$scratch/root" dfdyn --version
        inside "$scratch/root" dfdyn man start | grep -q '^\.SH NAME'
        echo "the library compiles from its package"
    fi
    rm -rf "$scratch/root"
done
