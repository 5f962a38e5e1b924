#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# manual.sh DFDYN: checks the manual pages, and the completion in bash, that the program prints.
set -euo pipefail
dfdyn=$1

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$dfdyn" man -o "$scratch/man"
mapfile -t commands < <("$dfdyn" --help | sed -n '/^Subcommands:/,$ s/^  \([a-z]\+\) .*/\1/p')
[[ ${#commands[@]} -ge 16 ]]
for command in "${commands[@]}"; do
    page=$scratch/man/dfdyn-$command.1
    "$dfdyn" man "$command" | cmp - "$page"
    while read -r option; do
        grep -qF -- "${option//-/\\-}" "$page"
    done < <("$dfdyn" "$command" --help | grep -oE -- '^  (-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
done
if command -v groff >/dev/null; then
    for page in "$scratch"/man/*.1; do
        warnings=$(groff -man -ww -z "$page" 2>&1)
        [[ -z $warnings ]] || {
            echo "$page: $warnings"
            exit 1
        }
    done
fi

"$dfdyn" completion bash >"$scratch/completion"
bash -n "$scratch/completion"
# complete WORD...: prints what bash offers for the last word
complete_words() {
    bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _dfdyn; echo "${COMPREPLY[*]}"' _ "$scratch/completion" "$@"
}
[[ $(complete_words dfdyn tra) == train ]]
[[ $(complete_words dfdyn train --feat) == "--features-per-joint --features" ]]
[[ $(complete_words dfdyn train --model S) == "SP SP2 SPK" ]]
[[ $(complete_words dfdyn replay --fro) == "--from --from-prior --frozen" ]]
cd "$scratch" && touch run.csv
[[ $(complete_words dfdyn train --log ru) == run.csv ]]
