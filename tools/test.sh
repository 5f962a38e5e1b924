#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# test.sh [--long]: installs missing packages, builds and runs all checks. --long adds the tests that take minutes. The logs
# are in build/logs. The last line reports that all passed, or the step that failed and its log.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

jobs=$(nproc)
log_dir=build/logs

# All except the header that make_ur5_model.sh writes.
all_sources() {
    find firmware_lib hal tools examples tests '(' -name '*.hpp' -o -name '*.cpp' ')' ! -name ur5_model.hpp -print0
}

install_packages() { tools/install_packages.sh test; }

check_style() {
    all_sources | xargs -0 clang-format --dry-run --Werror
    find .ci cmake tools examples tests firmware_lib hal '(' -name '*.sh' -o -path .ci/run ')' -print0 | xargs -0 shellcheck
}

# build PRESET [TARGET...]
build() {
    local preset=$1
    shift
    cmake --preset "$preset"
    cmake --build --preset "$preset" --parallel "$jobs" ${1:+--target "$@"}
}

run_tests() {
    ctest --preset "$1" --parallel "$jobs" "${@:2}"
}

build_release() { build release; }
test_units() { run_tests release --label-regex '^(firmware|hal|tools|embedding|truth|headers|panel)$'; }
# --verbose: what a stalled machine could not judge is in the log.
test_promises() { run_tests release --label-regex '^(acceptance|vcan)$' --verbose; }
test_elsewhere() { run_tests release --label-regex '^(consumer|packaging|cortex_m|realtime)$' --verbose; }
# Every plan of the experiment, with one draw and few rows.
test_experiment() { tools/reproduce.sh --quick; }
test_long() { ctest --test-dir build/release --label-regex '^long$' --parallel "$jobs" --output-on-failure --no-tests=error; }

# clang++ has the sanitizers: it builds them in about three quarters of the time that g++ takes, and is the second compiler.
test_sanitized() {
    build asan-ubsan dfdyn_embedding dfdyn_linux_loop dfdyn_firmware_tests dfdyn_hal_tests
    # Bare-metal code has no sanitizer, and was tested above.
    run_tests asan-ubsan --label-regex '^(firmware|hal|embedding)$' --exclude-regex '^hal\.bare_metal$'
}
test_sanitized_tools() {
    build asan-ubsan dfdyn_tools_tests
    run_tests asan-ubsan --label-regex '^tools$'
}

# Optimised, unlike the sanitized build.
test_clang() {
    build clang dfdyn_embedding dfdyn_linux_loop dfdyn_firmware_tests dfdyn_hal_tests
    run_tests clang --label-regex '^(firmware|hal|embedding)$'
}

# With the flags of the clang build.
analyse() {
    cmake --preset clang
    cmake --build --preset clang --target dfdyn_make_ur5_tables
    run-clang-tidy -quiet -p build/clang -j "$jobs" "$PWD/($1)/.*"
}
# tools/model/run_time has all of the firmware's headers.
analyse_firmware() { analyse 'firmware_lib|hal|examples|tools/model/run_time'; }
analyse_others() { analyse 'tools|tests'; }

steps=(
    "install_packages:Debian packages"
    "check_style:formatting and scripts"
    "build_release:release build"
    "test_units:unit tests and firmware headers"
    "test_promises:promises on real recordings (the demo); CAN backend and dfdyn play on a kernel's virtual CAN, against can-utils"
    "test_elsewhere:use by another project, on bare Cortex-M cores under QEMU, and that nothing in the loop blocks"
    "test_sanitized:firmware and bus layer by clang++, address and undefined-behaviour sanitizers"
    "analyse_firmware:static analysis of the firmware and the bus layer"
)
case ${1:-} in
"") ;;
--long)
    steps+=(
        "test_sanitized_tools:host tools by clang++, address and undefined-behaviour sanitizers"
        "test_long:long tests"
        "test_experiment:the experiment's plans, quickly"
        "test_clang:optimised clang++ build of the firmware"
        "analyse_others:static analysis of the host tools and the tests"
    )
    ;;
*)
    echo "usage: tools/test.sh [--long]" >&2
    exit 2
    ;;
esac

# The lines of a log that belong on the terminal.
highlights() {
    grep -hE '^[0-9]+% tests passed|cortex-m[0-9a-z-]+: (dfdyn_c|instr|bench)|the target, |realtime: |not installed:|not judged:' "$1" | sed -E 's/^([0-9]+: *)+//; s/^/        /' || return 0
}

# run_step NUMBER FUNCTION TITLE
run_step() {
    local log status=0 start=$SECONDS
    log=$log_dir/$(printf '%02d' "$1")-$2.log
    printf '[%d/%d] %s ... ' "$1" "${#steps[@]}" "$3"
    set +e
    (
        set -euo pipefail
        "$2"
    ) >"$log" 2>&1
    status=$?
    set -e
    if [[ $status -ne 0 ]]; then
        echo "failed after $((SECONDS - start)) s"
        tail -n 40 "$log"
        grep -E -A 5 ' FAILED:$|: error:' "$log" | head -n 30 || true
        echo "FAILED after $SECONDS s: step $1 of ${#steps[@]}, $3; the log is $log"
        exit 1
    fi
    echo "$((SECONDS - start)) s"
    highlights "$log"
}

mkdir -p "$log_dir"
number=0
for step in "${steps[@]}"; do
    number=$((number + 1))
    run_step "$number" "${step%%:*}" "${step#*:}"
done
echo "PASSED: all ${#steps[@]} steps, $SECONDS s"
