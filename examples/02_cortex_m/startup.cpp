// SPDX-License-Identifier: Apache-2.0
// From reset to the application: vector table, floating-point unit, memory and constructors.
#include "semihosting.hpp"
#include "stack_watermark.hpp"

#include <cstdint>

int application(); // application.cpp

extern "C" {

extern std::uint32_t data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
extern const std::uint32_t data_load[];
using Initialiser = void (*)();
extern const Initialiser init_array_begin[], init_array_end[];

[[noreturn]] void fault_handler() {
    semihosting::write("fault: an exception of the processor that nothing handles\n");
    semihosting::exit(3);
}

/// Defined by a program that uses the timer's interrupt.
[[gnu::weak]] void systick_handler() { fault_handler(); }

[[noreturn]] void start() {
    std::uint32_t* to = data_begin;
    for (const std::uint32_t* from = data_load; to != data_end; ++from, ++to) {
        *to = *from;
    }
    for (std::uint32_t* word = bss_begin; word != bss_end; ++word) {
        *word = 0;
    }
    for (const Initialiser* initialise = init_array_begin; initialise != init_array_end; ++initialise) {
        (*initialise)();
    }
    paint_stack();
    semihosting::exit(application());
}

// No floating-point register may be used before the unit is enabled. This function is therefore separate from
// code that the compiler may vectorise.
[[noreturn, gnu::naked]] void reset_handler() {
    asm volatile("ldr r0, =0xE000ED88\n" // CPACR: full access to coprocessors 10 and 11
                 "ldr r1, [r0]\n"
                 "orr r1, r1, #(0xF << 20)\n"
                 "str r1, [r0]\n"
                 "dsb\n"
                 "isb\n"
                 "b start\n");
}

using Handler = void (*)();
struct VectorTable {
    std::uint32_t* initial_stack;
    Handler handlers[15];
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable vector_table = {
    stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, nullptr,
     nullptr, nullptr, nullptr, fault_handler, fault_handler, nullptr, fault_handler, systick_handler}};

} // extern "C"
