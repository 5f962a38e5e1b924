#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# arduino_library.sh FOLDER: writes the library for Arduino into the new folder FOLDER, such as ~/Arduino/libraries/dfdyn.
set -euo pipefail
[[ $# -eq 1 ]] || {
    echo "usage: tools/arduino_library.sh FOLDER" >&2
    exit 2
}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

mkdir "$1"
cp -r "$source/firmware_lib/include" "$1/src"
cp -r "$source/hal/include/dfdyn/hal" "$1/src/dfdyn"
cp "$source/library.properties" "$source/LICENSE" "$source/README.md" "$1"
