#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# debian.sh BUILD VERSION: makes the Debian packages of a build, unpacks them into an empty folder, and uses what is in it.
set -euo pipefail
build=$1 version=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cpack --config "$build/CPackConfig.cmake" -B "$scratch/packages" >"$scratch/cpack.log" || {
    cat "$scratch/cpack.log"
    exit 1
}
root=$scratch/root
for name in dfdyn libdfdyn-dev; do
    package=$(find "$scratch/packages" -maxdepth 1 -name "${name}_*.deb")
    [[ $(dpkg-deb --field "$package" Package) == "$name" ]]
    [[ $(dpkg-deb --field "$package" Version) == "$version" ]]
    dpkg-deb -x "$package" "$root"
done
dpkg-deb --field "$scratch"/packages/dfdyn_*.deb Depends | grep -q libc6

[[ $("$root/usr/bin/dfdyn" --version) == "dfdyn $version"* ]]
test -s "$root/usr/share/man/man1/dfdyn-train.1"
test -s "$root/usr/share/doc/dfdyn/LICENSE"
test -s "$root/usr/share/doc/libdfdyn-dev/LICENSE"
bash -n "$root/usr/share/bash-completion/completions/dfdyn"
"$root/usr/bin/dfdyn" train --log "$here/../data/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv" --rows :1200 \
    --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 --quiet -o "$scratch/model.json" >/dev/null
test -s "$scratch/model.json"

# The library is used without the program; nothing of this machine's instructions is handed on.
PKG_CONFIG_PATH=$(dirname "$(find "$root" -name dfdyn.pc)")
export PKG_CONFIG_PATH
read -ra flags <<<"$(pkg-config --cflags dfdyn)"
c++ -std=c++20 "${flags[@]}" -fsyntax-only "$here/consumer.cpp"
config=$(find "$root" -path "*/cmake/dfdyn" -type d)
[[ -n $config ]]
if grep -r march "$config"; then
    echo "the installed library hands on -march"
    exit 1
fi
