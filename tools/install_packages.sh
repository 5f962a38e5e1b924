#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# install_packages.sh demo|test|virtual-time: installs the missing Debian packages: for building and running the demo, for the
# tests as well, or only for the kernel of tests/vcan/virtual_time. If no package is missing, it changes nothing and needs no network.
set -euo pipefail

# package:consequence of its absence
demo_packages=(
    "cmake:nothing can be built"
    "ninja-build:nothing can be built with the presets"
    "g++:nothing can be built"
    "libeigen3-dev:nothing can be built"
    "libcli11-dev:the program dfdyn cannot be built"
    "nlohmann-json3-dev:the program dfdyn cannot be built"
    "libnlopt-cxx-dev:dfdyn train cannot be built"
    "liburdfdom-dev:no robot can be read from its description"
    "libtinyxml2-dev:no robot can be read from its description"
    "libzstd-dev:no ROS 2 bag (MCAP) with zstd chunks can be read"
    "liblz4-dev:no ROS 2 bag (MCAP) with lz4 chunks can be read"
    "libsqlite3-dev:no ROS 2 bag of SQLite can be read"
    "zlib1g-dev:the program dfdyn cannot be built"
)
test_packages=(
    "catch2:the unit tests cannot be built"
    "libkdl-parser-dev:the robots that are read cannot be compared with KDL's reading of them"
    "liborocos-kdl-dev:no comparison with other programs' dynamics"
    "libdart-dev:no comparison with other programs' dynamics"
    "clang:no build with a second compiler"
    "libclang-rt-dev:no build with the sanitizers"
    "clang-format:no check of the formatting"
    "clang-tidy:no static analysis"
    "shellcheck:no check of the scripts"
    "gcc-arm-none-eabi:no build for the Cortex-M cores"
    "libnewlib-arm-none-eabi:no build for the Cortex-M cores"
    "libstdc++-arm-none-eabi-newlib:no build for the Cortex-M cores"
    "qemu-system-arm:no run on the Cortex-M cores"
    "can-utils:the CAN backend cannot be tested against other programs"
    "python3:the frames of DBC files cannot be read by another program"
    "python3-can:the frames of DBC files cannot be read by another program"
    "doxygen:the reference of the headers cannot be checked"
    "debootstrap:the packages cannot be tried on a clean system"
    "iproute2:the CAN backend cannot be tested"
    "kmod:the CAN backend cannot be tested where the kernel has no CAN"
    "user-mode-linux:the CAN backend cannot be tested where the kernel has no CAN"
)
virtual_time_packages=(
    "linux-source-6.12:no kernel with virtual time"
    "xz-utils:its source cannot be unpacked"
    "make:it cannot be built"
    "gcc:it cannot be built"
    "libc6-dev:it cannot be built"
    "flex:it cannot be built"
    "bison:it cannot be built"
    "bc:it cannot be built"
    "perl-base:the virtual machine cannot be shut down"
    "iproute2:it has no CAN interface"
)

# Not available everywhere; tests that need them report that they checked nothing.
optional_test_packages=("clang-22" "libclang-rt-22-dev")

is_installed() {
    [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# The packages of the arguments "package:consequence" that are not installed.
missing_of() {
    local entry
    for entry in "$@"; do
        is_installed "${entry%%:*}" || echo "${entry%%:*}"
    done
}

as_root() {
    if [[ $(id -u) -eq 0 ]]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    else
        sudo env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}

apt_install() {
    as_root apt-get -o DPkg::Lock::Timeout=300 install --yes --no-install-recommends "$@"
}

install_optional() {
    local package
    for package in "$@"; do
        is_installed "$package" || apt_install "$package" || echo "not available here: $package"
    done
}

# Prints each package that is still missing after all tries, with apt's reason and the consequence.
explain_missing() {
    local entry package
    for entry in "${packages[@]}"; do
        package=${entry%%:*}
        if ! is_installed "$package"; then
            echo "not installed: $package, so ${entry#*:}. apt-get says:" >&2
            apt_install "$package" 2>&1 | grep -E '^(E|W):|sudo:' | tail -n 3 | sed 's/^/    /' >&2
        fi
    done
}

optional=()
case ${1:-} in
demo) packages=("${demo_packages[@]}") ;;
test)
    packages=("${demo_packages[@]}" "${test_packages[@]}")
    optional=("${optional_test_packages[@]}")
    ;;
virtual-time) packages=("${virtual_time_packages[@]}") ;;
*)
    echo "usage: install_packages.sh demo|test|virtual-time" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null; then
    echo "not a Debian system: make sure that the content of these packages is installed: ${packages[*]%%:*}" >&2
    exit 0
fi

mapfile -t missing < <(missing_of "${packages[@]}")
if [[ ${#missing[@]} -eq 0 ]]; then
    echo "all ${#packages[@]} packages are there"
    install_optional "${optional[@]}"
    exit 0
fi

echo "installing: ${missing[*]}"
if ! apt_install "${missing[@]}"; then
    echo "apt-get could not; once more with a fresh list of packages"
    as_root apt-get update || echo "apt-get update failed too"
    for package in "${missing[@]}"; do
        apt_install "$package" || echo "apt-get could not install $package"
    done
fi

mapfile -t missing < <(missing_of "${packages[@]}")
if [[ ${#missing[@]} -gt 0 ]]; then
    explain_missing
    exit 1
fi
install_optional "${optional[@]}"
