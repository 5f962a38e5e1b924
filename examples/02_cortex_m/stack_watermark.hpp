// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

extern "C" std::uint32_t stack_bottom[], stack_top[];

constexpr std::uint32_t stack_paint = 0xC5C5C5C5;

/// Fills the unused part of the stack with a pattern for the functions below; returns the end of the pattern.
[[gnu::always_inline]] inline const std::uint32_t* paint_stack() {
    std::uint32_t* stack_pointer = nullptr;
    asm volatile("mov %0, sp" : "=r"(stack_pointer));
    for (volatile std::uint32_t* word = stack_bottom; word < stack_pointer; ++word) {
        *word = stack_paint;
    }
    return stack_pointer;
}

/// Returns the maximum depth of the stack since paint_stack(), in bytes from `top`.
inline std::uint32_t stack_used_bytes(const std::uint32_t* top = stack_top) {
    const volatile std::uint32_t* word = stack_bottom;
    while (word < top && *word == stack_paint) {
        ++word;
    }
    return static_cast<std::uint32_t>(top - word) * 4;
}
