#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# pkg_config.sh CXX BUILD VERSION: installs the build to a folder, moves the folder, and compiles and links with what pkg-config prints.
set -euo pipefail
compiler=$1 build=$2 version=$3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/consumer.cpp

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build" --prefix "$scratch/first" >/dev/null
mv "$scratch/first" "$scratch/moved"
PKG_CONFIG_PATH=$(dirname "$(find "$scratch/moved" -name dfdyn-hal.pc)")
export PKG_CONFIG_PATH

[[ $(pkg-config --modversion dfdyn) == "$version" ]]
read -ra flags <<<"$(pkg-config --cflags dfdyn)"
"$compiler" -std=c++20 "${flags[@]}" -fsyntax-only "$source"

cat >"$scratch/bus.cpp" <<'CPP'
#include <dfdyn/hal/socketcan_bus.hpp>

int main() {
    try {
        const dfdyn::hal::SocketCanBus bus({.interface = "no_such_can", .filters = {}, .receive_own = false});
        return 1;
    } catch (const dfdyn::hal::BusError&) {
        return 0;
    }
}
CPP
read -ra flags <<<"$(pkg-config --cflags --libs dfdyn-hal)"
"$compiler" -std=c++20 "$scratch/bus.cpp" "${flags[@]}" -o "$scratch/bus"
"$scratch/bus"
