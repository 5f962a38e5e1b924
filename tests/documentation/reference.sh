#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# reference.sh SOURCE OUT: builds the reference of the public headers as docs/Doxyfile describes it, with its pages in OUT. Fails on a warning.
set -euo pipefail
cd "$1/docs"
{ cat Doxyfile && echo "OUTPUT_DIRECTORY = $2"; } | doxygen -
for page in classdfdyn_1_1Estimator classdfdyn_1_1FeedForward structdfdyn_1_1Sample; do
    test -s "$2/html/$page.html"
done
