#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# picture.sh REPORT.html OUT.png: the top of a report as a picture, for a README. Needs chromium.
set -euo pipefail
report=$(realpath "${1:?usage: picture.sh REPORT.html OUT.png}")
picture=$(realpath -m "${2:?usage: picture.sh REPORT.html OUT.png}")
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT
chromium --headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --hide-scrollbars --force-device-scale-factor=1 \
    --user-data-dir="$profile" --window-size=1400,"${3:-2060}" --screenshot="$picture" "file://$report" 2>/dev/null
echo "$picture"
