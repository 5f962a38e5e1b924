// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#if defined(__ARM_FEATURE_MVE) && defined(__GNUC__) && !defined(__clang__) && __GNUC__ <= 12
#error "g++ 12 compares only the first float of a vector here: compile with -mcpu=cortex-m55+nomve"
#endif

namespace dfdyn::detail {

#if defined(__AVX__)
inline constexpr int vector_bytes =
    32; // with AVX-512 too: on Zen 4 a sweep takes up to a tenth longer with 64
#elif defined(__SSE2__) || defined(__ARM_NEON)
inline constexpr int vector_bytes = 16;
#else
inline constexpr int vector_bytes = 0; // no vector instructions: one scalar at a time
#endif

/// Scalars per vector of the machine.
template <class Scalar>
inline constexpr int wide = std::max(1, vector_bytes / static_cast<int>(sizeof(Scalar)));

/// `lanes` numbers as one. The compilers' own vector type, because a sum that is kept in lanes by hand is
/// vectorised by some versions at some levels only. Values move by reference: how a call passes a vector
/// depends on the machine's options. All that is asked of vectors is here, so that a scalar of another kind
/// can bring its own.
template <class Scalar, int lanes>
struct Vector {
    // The attribute needs a typedef: NOLINTNEXTLINE(modernize-use-using)
    typedef Scalar Type __attribute__((vector_size(lanes * sizeof(Scalar))));
    using Mask = decltype(Type{} < Type{}); ///< whole numbers as wide as the scalar; as a condition: -1 or 0

    static void load(const Scalar* address, Type& vector) noexcept {
        std::memcpy(&vector, address, sizeof vector);
    }
    static void store(const Type& vector, Scalar* address) noexcept {
        std::memcpy(address, &vector, sizeof vector);
    }

    /// The halves are added until one number is left, which takes as many steps as `lanes` has bits.
    static Scalar total(const Type& vector) noexcept {
        if constexpr (lanes == 2) {
            return vector[0] + vector[1];
        } else {
            typename Vector<Scalar, lanes / 2>::Type sum;
            add_halves(vector, sum, std::make_integer_sequence<int, lanes / 2>{});
            return Vector<Scalar, lanes / 2>::total(sum);
        }
    }

    /// Lane by lane: where the condition holds `yes`, else `no`.
    static void select(const Mask& condition, const Type& yes, const Type& no, Type& result) noexcept {
        result = condition ? yes : no;
    }
    /// Towards zero.
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

/// A machine without vectors: plain scalars, which stay in its floating-point registers.
template <class Scalar>
struct Vector<Scalar, 1> {
    using Type = Scalar;

    static void load(const Scalar* address, Type& vector) noexcept { vector = *address; }
    static void store(const Type& vector, Scalar* address) noexcept { *address = vector; }
    static Scalar total(const Type& vector) noexcept { return vector; }
};

} // namespace dfdyn::detail
