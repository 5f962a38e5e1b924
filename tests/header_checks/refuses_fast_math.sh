#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# refuses_fast_math.sh COMPILER INCLUDE_DIRS HEADER...: fails if a translation unit that includes one of these headers compiles
# with flags under which the library would silently be wrong, with an older language standard or an older g++
# (dfdyn/core/strict_math.hpp). INCLUDE_DIRS are the folders of the headers, separated by colons. A header without floating-point
# numbers need not be rejected.
set -euo pipefail

compiler=$1
IFS=: read -r -a include_dirs <<<"$2"
shift 2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bad=0

# message FLAG...: the compiler's messages for a translation unit that contains only the check.
message() {
    echo '#include "dfdyn/core/strict_math.hpp"' >"$scratch/unit.cpp"
    "$compiler" -std=c++20 "${include_dirs[@]/#/-I}" -w "$@" -fsyntax-only "$scratch/unit.cpp" 2>&1 || true
}

# expect refuses|accepts FLAG...
expect() {
    local wanted=$1 outcome=accepts said
    shift
    said=$(message "$@")
    if grep -qE 'error.*dfdyn (does not work with.*Compile this file without|needs (g\+\+ 12|C\+\+20))' <<<"$said"; then
        outcome=refuses
    elif [[ -n $said ]]; then
        outcome="says otherwise of"
    fi
    if [[ $outcome != "$wanted" ]]; then
        echo "dfdyn/core/strict_math.hpp $outcome $*: $said"
        bad=1
    fi
}

expect accepts -O3
expect accepts -O3 -fno-math-errno -ffp-contract=fast
expect accepts -ffast-math -fno-fast-math
expect refuses -ffast-math
expect refuses -Ofast
expect refuses -O1 -ffinite-math-only
expect refuses -std=c++17
if ! "$compiler" --version | grep -q clang; then # clang has no macro for these, and no version is refused
    expect refuses -ffast-math -fno-finite-math-only
    expect refuses -funsafe-math-optimizations
    expect refuses -U__GNUC__ -D__GNUC__=11
fi

# Every header includes the check through headers of this project.
if ! perl -e '
    my ($dirs, @headers) = @ARGV;
    my (%text, %reaches);
    sub text_of {
        my ($header) = @_;
        for my $dir (split /:/, $dirs) {
            next unless open my $file, "<", "$dir/$header";
            local $/;
            return <$file>;
        }
        die "$header: not found below $dirs\n";
    }
    sub reaches {
        my ($header) = @_;
        return $reaches{$header} if defined $reaches{$header};
        $reaches{$header} = $header eq "dfdyn/core/strict_math.hpp";
        $text{$header} = text_of($header);
        for my $next ($text{$header} =~ /^#include "(dfdyn\/[^"]+)"/gm) {
            $reaches{$header} ||= reaches($next);
        }
        return $reaches{$header};
    }
    my @without = grep { !reaches($_) && $text{$_} =~ /\b(float|double|Scalar|isfinite)\b/ } @headers;
    print "$_: does not include dfdyn/core/strict_math.hpp\n" for @without;
    exit(@headers == 0 || @without > 0);
' "$(IFS=:; echo "${include_dirs[*]}")" "$@"; then
    bad=1
fi
exit "$bad"
