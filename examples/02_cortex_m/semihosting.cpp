// SPDX-License-Identifier: Apache-2.0
#include "semihosting.hpp"

#include <array>

namespace semihosting {
namespace {

constexpr std::uint32_t sys_write0 = 0x04;
constexpr std::uint32_t sys_exit_extended = 0x20;
constexpr std::uint32_t application_exit = 0x20026;

void call(std::uint32_t operation, const void* argument) {
    register std::uint32_t r0 asm("r0") = operation;
    register const void* r1 asm("r1") = argument;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

} // namespace

void write(const char* text) { call(sys_write0, text); }

void write(std::uint32_t number) {
    std::array<char, 11> digits{};
    std::size_t first = digits.size() - 1; // the last element is the terminating zero
    do {
        digits[--first] = static_cast<char>('0' + number % 10);
        number /= 10;
    } while (number != 0);
    write(&digits[first]);
}

void exit(int status) {
    const std::array<std::uint32_t, 2> reason{application_exit, static_cast<std::uint32_t>(status)};
    while (true) {
        call(sys_exit_extended, reason.data());
    }
}

} // namespace semihosting
