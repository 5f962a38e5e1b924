// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// Weights of a first-order whitening filter: of a value and of the one before it. The result is nearly white
/// with unit variance.
template <class Scalar>
struct Whitening {
    Scalar now, before;

    [[nodiscard]] Scalar of(Scalar value, Scalar value_before) const noexcept {
        return now * value - before * value_before;
    }
};

/// Classes of a joint's speed: stationary, creeping, moving.
template <class Scalar>
struct SpeedClasses {
    static constexpr int count = 3;
    Scalar standing, creeping; ///< rad/s, m/s: upper bounds of the first two classes

    [[nodiscard]] constexpr int of(Scalar speed) const noexcept {
        return speed < standing ? 0 : speed < creeping ? 1 : 2;
    }
};

/// Estimates the scale and the first-order autocorrelation of one output's block means in the absence of a
/// change.
///
/// At low speed stiction makes the residual of a joint torque several times larger than in motion, and
/// slower. Both are therefore estimated separately for each class of the joint's speed. Within a class the
/// whitened block means are nearly Gaussian.
///
/// The scale s is Huber's: s² solves E[min(x², c² s²)] = κ s² with c = 2.5 and κ for Gaussian noise (P. J.
/// Huber, "Robust Statistics", 1981, proposal 2). It is insensitive to bursts. It starts with the smallest
/// magnitude of the `first` blocks of a class. The gain of block n is 2/(n+2), later 1/`memory`.
/// Memory: 13 scalars.
template <class Scalar>
class BlockNoise {
  public:
    static constexpr Scalar memory = 600;              ///< blocks of a class
    static constexpr Scalar needed = 30;               ///< blocks of a class before it is used
    static constexpr Scalar most_alike = Scalar(0.95); ///< largest autocorrelation

    static constexpr int cost = 2 * function_cost + 25; ///< of `learn`, `smallest` and `whitening`

    BlockNoise() noexcept = default;
    /// `least_scale`: lower bound of the scales.
    explicit BlockNoise(Scalar least_scale) noexcept : least_(least_scale * least_scale) {}

    /// Adds a block mean of speed class `c`, 0 … 2, and its predecessor of class `before` (-1: none). Ignores
    /// values that are not finite.
    void learn(Scalar block, Scalar block_before, int c, int before) noexcept {
        if (!std::isfinite(block) || !std::isfinite(block_before)) {
            return;
        }
        Class& one = class_[c];
        const Scalar value = std::clamp(block, -largest, largest);
        one.blocks = std::min(one.blocks + 1, 2 * memory);
        if (one.blocks <= first) {
            one.square =
                std::max(std::min(value * value, one.blocks > 1 ? one.square : largest * largest), least_);
            return;
        }
        const Scalar gain = 2 / (one.blocks + 2);
        const Scalar square = std::min(value * value, clip * clip * one.square);
        one.square = std::max(one.square + gain * (square / consistency - one.square), least_);
        if (c == before) {
            const Scalar limit = clip * scale(c);
            const Scalar now = std::clamp(value, -limit, limit) / limit;
            const Scalar last = std::clamp(block_before, -limit, limit) / limit;
            one.power += gain * (last * last - one.power);
            one.product += gain * (now * last - one.product);
        }
    }

    /// Learns the noise again, starting from the present estimates: it has changed permanently.
    void relearn() noexcept {
        for (Class& one : class_) {
            one.blocks = std::min(one.blocks, Scalar(10));
        }
    }

    [[nodiscard]] bool known(int c) const noexcept { return class_[c].blocks >= needed; }
    [[nodiscard]] Scalar scale(int c) const noexcept {
        using std::sqrt;
        return sqrt(class_[c].square);
    }
    /// Returns the autocorrelation, 0 … `most_alike`.
    [[nodiscard]] Scalar autocorrelation(int c) const noexcept {
        const Class& one = class_[c];
        return one.power > 0 ? std::clamp(one.product / one.power, Scalar(0), most_alike) : Scalar(0);
    }
    /// Returns the smallest scale of the known classes, 0 if there is none.
    [[nodiscard]] Scalar smallest() const noexcept {
        Scalar least_square = 0;
        for (int c = 0; c < SpeedClasses<Scalar>::count; ++c) {
            const bool smaller = least_square == 0 || class_[c].square < least_square;
            least_square = known(c) && smaller ? class_[c].square : least_square;
        }
        using std::sqrt;
        return sqrt(least_square);
    }

    /// Returns the whitening filter of a block of class `c` after one of class `before`. Zero weights if the
    /// class is not known.
    [[nodiscard]] Whitening<Scalar> whitening(int c, int before) const noexcept {
        if (!known(c)) {
            return {0, 0};
        }
        using std::sqrt;
        const Scalar a = c == before ? autocorrelation(c) : Scalar(0);
        const Scalar weight = 1 / sqrt(class_[c].square * (1 - a * a));
        return {weight, a * weight};
    }

  private:
    static constexpr Scalar largest = Scalar(1e15); ///< magnitude; larger values are clamped
    static constexpr Scalar first = 5;              ///< blocks
    static constexpr Scalar clip = Scalar(2.5);
    static constexpr Scalar consistency = Scalar(0.9776); ///< E[min(z², clip²)] of a standard normal z

    struct Class {
        Scalar square = 1;
        Scalar power = 0, product = 0;
        Scalar blocks = 0;
    };
    Class class_[SpeedClasses<Scalar>::count];
    Scalar least_ = Scalar(1e-12); ///< square of a scale
};

} // namespace dfdyn
