#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# build_kernel.sh FOLDER: builds FOLDER/linux.uml, a user-mode Linux with CAN whose time can stop while programs run
# (time-travel=inf-cpu), from the package linux-source-6.12 and kernel.config. Takes about 5 minutes and 2 GB of disk, and no
# time if it was built from the same sources before. Installs the packages that it needs.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=${1:?usage: build_kernel.sh FOLDER}
jobs=${DFDYN_KERNEL_JOBS:-$(nproc)}
source=linux-source-6.12

mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
if [[ -x $folder/linux.uml ]] && cmp --silent "$here/kernel.config" "$folder/kernel.config"; then
    exit 0
fi
"$here/../../../tools/install_packages.sh" virtual-time

scratch=$(mktemp -d "$folder/build.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
echo "unpacking $source"
tar --extract --file "/usr/src/$source.tar.xz" --directory "$scratch" --strip-components 1

build() { nice make --directory "$scratch" --silent ARCH=um --jobs "$jobs" "$@"; }
build KCONFIG_ALLCONFIG="$here/kernel.config" allnoconfig
if missing=$(grep '=y' "$here/kernel.config" | grep --invert-match --line-regexp --fixed-strings --file "$scratch/.config"); then
    echo "kernel.config asks for what this kernel cannot have so: $missing" >&2
    exit 1
fi
echo "building with $jobs jobs; the log is $folder/build.log"
build linux >"$folder/build.log" 2>&1 || {
    tail -n 30 "$folder/build.log" >&2
    exit 1
}
mv "$scratch/linux" "$folder/linux.uml"
cp "$here/kernel.config" "$folder/kernel.config"
echo "built $folder/linux.uml in $SECONDS s"
