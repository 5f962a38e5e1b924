#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# reference.sh SOURCE OUT: builds the reference of the public headers as docs/Doxyfile describes it, with its pages in OUT. Fails on a
# warning, and on a public member without a comment, except in the headers of undocumented_members.txt: there their number must not grow.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
out=$2
mkdir -p "$out"
cd "$1/docs"
{ cat Doxyfile && echo "OUTPUT_DIRECTORY = $out"; } | doxygen -
for page in classdfdyn_1_1Estimator classdfdyn_1_1FeedForward structdfdyn_1_1Sample; do
    test -s "$out/html/$page.html"
done

# A second run without EXTRACT_ALL, which hides members without a comment. Only its warnings are used.
members() {
    cat Doxyfile
    cat <<END
OUTPUT_DIRECTORY = $out/members
GENERATE_HTML = NO
GENERATE_XML = YES
EXTRACT_ALL = NO
EXCLUDE_SYMBOLS = dfdyn::detail dfdyn::detail::* dfdyn::hal::detail dfdyn::hal::detail::*
WARN_IF_UNDOCUMENTED = YES
WARN_AS_ERROR = NO
WARN_LOGFILE = $out/members.txt
END
}
mkdir -p "$out/members"
members | doxygen -
grep -q . "$out/members.txt" # doxygen changed its options otherwise: some members are known to have no comment
source=$(cd .. && pwd)
sed -nE "s|^$source/([^:]+):[0-9]+: warning: .* is not documented\.?$|\1|p" "$out/members.txt" | sort | uniq -c |
    awk '{ print $2, $1 }' >"$out/undocumented.txt"
if ! diff <(grep -v '^#' "$here/undocumented_members.txt") "$out/undocumented.txt" >"$out/difference.txt"; then
    echo "undocumented_members.txt has lines '<', found '>' (header, public members without a comment):"
    cat "$out/difference.txt"
    echo "Comment new members; where there are fewer than listed, correct the list. The members:"
    sed -nE 's/^> ([^ ]+) .*/\1/p' "$out/difference.txt" | while read -r header; do grep -F "/$header:" "$out/members.txt"; done
    exit 1
fi
echo "$(wc -l <"$out/undocumented.txt") headers have $(awk '{ sum += $2 } END { print sum }' "$out/undocumented.txt") public members without a comment, as listed"
