#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# checks_refuse.sh COMPILER INCLUDE_DIRS: proves that the checks of firmware headers reject each forbidden construct and accept a
# valid header. INCLUDE_DIRS are the folders of Eigen, separated by colons.
set -euo pipefail

compiler=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bad=0

# Reports all errors; clang's default is the first few.
error_limit=-fmax-errors=0
if "$compiler" --version | grep -q clang; then
    error_limit=-ferror-limit=0
fi
IFS=: read -r -a include_dirs <<<"$2"
flags=(-std=c++20 -fno-exceptions -fno-rtti "$error_limit" -I"$here")
for include_dir in "${include_dirs[@]}"; do
    flags+=(-isystem "$include_dir")
done

# expect accepts|refuses CODE: checks the result of check_text.sh for this code.
expect() {
    printf '#pragma once\n%s\n' "$2" >"$scratch/include/sample.hpp"
    local outcome=refuses
    if "$here/check_text.sh" "$scratch/include" sample.hpp >"$scratch/log" 2>&1; then
        outcome=accepts
    fi
    if [[ $outcome != "$1" ]]; then
        echo "check_text.sh $outcome what it should not: $2"
        cat "$scratch/log"
        bad=1
    fi
}

check_text_check() {
    expect accepts '// a new way: try { throw; } std::vector<int>
struct Delegate { Delegate(const Delegate&) = delete; int newest; };
#include <dfdyn/other.hpp>
#include <cmath>
/* delete typeid */ inline constexpr const char* text = "new \"vector\" throw";
inline char quote() { return '\''"'\''; } inline int many = 1'\''000; // new
'
    local code
    for code in 'int* p = new int;' 'void f(int* p) { delete p; }' 'void f() { throw 1; }' 'void f() { try { } catch (...) { } }' \
        'A* f(B* b) { return dynamic_cast<A*>(b); }' 'auto& t = typeid(int);' 'void f() { goto end; end:; }' \
        'thread_local int x;' 'std::vector<int> v;' 'std::string s;' 'std::function<void()> f;' 'std::map<int, int> m;' \
        'Eigen::MatrixXd m;' 'Eigen::VectorXf v;' 'Eigen::Matrix3Xd m;' 'Eigen::ArrayXXd a;' 'Eigen::RowVectorX<float> v;' \
        'Eigen::Matrix<float, Eigen::Dynamic, 1> v;' '#include <vector>' '#include "string"' '#include <iostream>' '# include <chrono>'; do
        expect refuses "$code"
    done
    rm "$scratch/include/sample.hpp"
}

# Compiles $1 like a firmware header; the messages are in the log.
compile() {
    ! "$compiler" "${flags[@]}" -fsyntax-only "$1" >"$scratch/log" 2>&1
}

# Each poisoned name, on a line of its own, must be an error on that line.
check_poison() {
    local names name line=1
    names=$(sed -n 's/^#pragma GCC poison //p' "$here/poison.hpp")
    echo '#include "poison.hpp"' >"$scratch/poisoned.cpp"
    for name in $names; do
        echo "int f_$name() { return $name; }" >>"$scratch/poisoned.cpp"
    done
    compile "$scratch/poisoned.cpp"
    for name in $names; do
        line=$((line + 1))
        if ! grep -qE "poisoned.cpp:$line:.*poisoned" "$scratch/log"; then
            echo "poison.hpp does not poison $name"
            bad=1
        fi
    done
}

# The compiler flags of the firmware reject language features that it may not use.
check_flags() {
    cat >"$scratch/flags.cpp" <<'CODE'
#include <typeinfo>
struct A { virtual ~A(); }; struct B : A {};
void f() { throw 1; }
B* g(A* a) { return dynamic_cast<B*>(a); }
const char* h() { return typeid(A).name(); }
CODE
    compile "$scratch/flags.cpp"
    local line
    for line in 3 4 5; do
        if ! grep -q "flags.cpp:$line:.*error" "$scratch/log"; then
            echo "the compiler accepts with ${flags[*]}: $(sed -n "${line}p" "$scratch/flags.cpp")"
            bad=1
        fi
    done
}

mkdir "$scratch/include"
check_text_check
check_poison
check_flags
exit "$bad"
