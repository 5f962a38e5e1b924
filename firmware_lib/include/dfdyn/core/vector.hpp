// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#if defined(__ARM_FEATURE_MVE) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ <= 12
#error "g++ 12 compares only the first float of a vector here: compile with -mcpu=cortex-m55+nomve"
#endif

namespace dfdyn::detail {

#if defined(__AVX__)
// Also with AVX-512: on Zen 4 a sweep takes up to a tenth longer with 64.
inline constexpr int vector_bytes = 32;
#elif defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr int vector_bytes = 16;
#else
inline constexpr int vector_bytes = 0; // no vector instructions: one scalar at a time
#endif

/// Number of scalars per vector register; 1 without vector instructions.
template <class Scalar>
inline constexpr int wide = std::max(1, vector_bytes / static_cast<int>(sizeof(Scalar)));

/// `lanes` numbers as one value. Uses the compilers' vector type, because not every compiler version
/// vectorises a sum that is kept in lanes by hand. Values are passed by reference: how a call passes a vector
/// depends on compiler options. All required operations are defined here, so that another kind of scalar can
/// provide its own.
template <class Scalar, int lanes>
struct Vector {
    // The attribute needs a typedef: NOLINTNEXTLINE(modernize-use-using)
    typedef Scalar Type __attribute__((vector_size(lanes * sizeof(Scalar))));
    /// Integers as wide as the scalar; as a condition: -1 or 0.
    using Mask = decltype(Type{} < Type{});

    static void load(const Scalar* address, Type& vector) noexcept {
        std::memcpy(&vector, address, sizeof vector);
    }
    static void store(const Type& vector, Scalar* address) noexcept {
        std::memcpy(address, &vector, sizeof vector);
    }

    /// Adds the two halves until one number is left: log2(`lanes`) steps.
    static Scalar total(const Type& vector) noexcept {
        if constexpr (lanes == 2) {
            return vector[0] + vector[1];
        } else {
            typename Vector<Scalar, lanes / 2>::Type sum;
            add_halves(vector, sum, std::make_integer_sequence<int, lanes / 2>{});
            return Vector<Scalar, lanes / 2>::total(sum);
        }
    }

    /// Sets each lane to `yes` where the condition holds and to `no` elsewhere.
    static void select(const Mask& condition, const Type& yes, const Type& no, Type& result) noexcept {
        result = condition ? yes : no;
    }
    /// Rounds each lane towards zero.
    static void truncate(const Type& vector, Mask& whole) noexcept {
        whole = __builtin_convertvector(vector, Mask);
    }
    static void convert(const Mask& whole, Type& vector) noexcept {
        vector = __builtin_convertvector(whole, Type);
    }

  private:
    template <class Half, int... lane>
    static void add_halves(const Type& vector, Half& sum,
                           std::integer_sequence<int, lane...> /*of the lower*/) noexcept {
        sum = __builtin_shufflevector(vector, vector, lane...) +
              __builtin_shufflevector(vector, vector, (lane + lanes / 2)...);
    }
};

/// A machine without vector instructions: plain scalars, which stay in floating-point registers.
template <class Scalar>
struct Vector<Scalar, 1> {
    using Type = Scalar;

    static void load(const Scalar* address, Type& vector) noexcept { vector = *address; }
    static void store(const Type& vector, Scalar* address) noexcept { *address = vector; }
    static Scalar total(const Type& vector) noexcept { return vector; }
};

} // namespace dfdyn::detail
