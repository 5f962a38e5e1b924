#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tutorial.sh DFDYN: runs every command of docs/guide/first-controller.md in an empty folder, in their order.
set -euo pipefail
PATH=$(dirname "$1"):$PATH
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
ln -s "$source/tests" tests

fence=$(printf '\140\140\140')
mapfile -t commands < <(awk -v fence="$fence" '$0 == fence {inside = 0} inside {print} $0 == fence "sh" {inside = 1}' \
    "$source/docs/guide/first-controller.md")
[[ ${#commands[@]} -ge 7 ]]
for command in "${commands[@]}"; do
    echo "\$ $command"
    bash -c "$command" 2>&1 | tee -a output.txt
done
[[ $(grep -c '^predictions as of dfdyn replay$' output.txt) -eq 2 ]]
test -s another.html
