#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_text.sh INCLUDE_DIR HEADER...: fails if one of these headers below INCLUDE_DIR uses a forbidden keyword or type, or
# includes a header that poison.hpp does not include. Comments and string literals do not count.
set -euo pipefail

include_dir=$1
shift
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

containers='vector|string|map|set|multimap|multiset|list|forward_list|deque|queue|stack|function|any|variant|thread'
forbidden="\bnew\b|\bdelete\b|\bthrow\b|\btry\b|\bcatch\b|\bdynamic_cast\b|\btypeid\b|\bgoto\b|\bthread_local\b"
forbidden+="|\bstd::($containers)\b"
forbidden+="|\b(Matrix|Vector|RowVector|Array|ArrayX)[0-9]?X[0-9]?[a-z]*\b|\bEigen::Dynamic\b|\bDynamic\b"

allowed_includes=$(sed -n 's/^#include <\(.*\)>$/\1/p' "$here/poison.hpp")

# The text of $1 as "line: text", without comments, contents of string literals and deleted functions.
code_of() {
    perl -0777 -pe 's{
            (^[ \t]*\#[ \t]*include[ \t]*[<"][^>"\n]*[>"])
          | ("(?:[^"\\\n]|\\.)*")
          | (?<![0-9])\x27(?:[^\x27\\\n]|\\.)\x27
          | //[^\n]* | /\*.*?\*/
        }{ defined $1 ? $1 : defined $2 ? q("") : $& =~ tr/\n//cdr }gsemx;
        s{=\s*delete\b}{}g; my $line = 0; s{^}{++$line . ": "}gme' "$1"
}

# The includes of $1 that are neither allowed nor from this project.
foreign_includes_of() {
    sed -nE 's/^[0-9]+: *# *include *[<"]([^>"]*)[>"].*/\1/p' <<<"$1" |
        awk 'NR == FNR { allowed[$0]; next } !($0 in allowed) && !/^dfdyn\//' <(echo "$allowed_includes") -
}

bad=0
for header in "$@"; do
    code=$(code_of "$include_dir/$header")
    if found=$(grep -E "^[0-9]+: .*($forbidden)" <<<"$code"); then
        echo "$header: forbidden in firmware:"
        echo "$found"
        bad=1
    fi
    foreign=$(foreign_includes_of "$code")
    if [[ -n $foreign ]]; then
        echo "$header: includes what firmware may not:" "$foreign"
        bad=1
    fi
done

if [[ $# -eq 0 ]]; then
    echo "no header to read below $include_dir"
    exit 1
fi
echo "$# headers read"
exit "$bad"
