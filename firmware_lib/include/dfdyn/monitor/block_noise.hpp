// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn {

/// What turns a value and the one before it into nearly white noise of unit deviation.
template <class Scalar>
struct Whitening {
    Scalar now, before;

    [[nodiscard]] Scalar of(Scalar value, Scalar value_before) const noexcept {
        return now * value - before * value_before;
    }
};

/// How fast a joint moves, in classes.
template <class Scalar>
struct SpeedClasses {
    static constexpr int count = 3;
    Scalar standing, creeping; ///< rad/s, m/s: a joint below the first stands, below the second it creeps

    [[nodiscard]] constexpr int of(Scalar speed) const noexcept {
        return speed < standing ? 0 : speed < creeping ? 1 : 2;
    }
};

/// How large one output's block means usually are, and how like the one before: learned while nothing
/// happens.
///
/// What a model leaves of a joint's torque is several times as large while the joint stands or creeps
/// (stiction) as while it moves, and hardly changes from block to block then. So scale and first-order
/// autocorrelation are kept for each class of its speed; within one, what is left is nearly Gaussian.
///
/// The scale is Huber's: s² follows E[min(x², c² s²)] = κ s², c = 2.5, κ its value for Gaussian noise (P. J.
/// Huber, "Robust Statistics", 1981, proposal 2), so that a burst counts for little. It begins with the
/// smallest of the `first` blocks of a class; the gain of block n is 2/(n+2), then 1/`memory`. 13 scalars.
template <class Scalar>
class BlockNoise {
  public:
    static constexpr Scalar memory = 600; ///< blocks of a class
    static constexpr Scalar needed = 30;  ///< blocks of a class before anything is known of it
    static constexpr Scalar most_alike =
        Scalar(0.95); ///< autocorrelation: beyond, a block would tell nothing

    static constexpr int cost = 2 * function_cost + 25; ///< of `learn`, `smallest` and `whitening`

    BlockNoise() noexcept = default;
    /// `least_scale`: lower bound of the scales.
    explicit BlockNoise(Scalar least_scale) noexcept : least_(least_scale * least_scale) {}

    /// A block of class `c`, after one of class `before` (-1: after none). One that is no number is passed
    /// over.
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

    /// Takes the noise to have changed for good: it is learned anew, from where it is.
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
    /// 0 … `most_alike`.
    [[nodiscard]] Scalar autocorrelation(int c) const noexcept {
        const Class& one = class_[c];
        return one.power > 0 ? std::clamp(one.product / one.power, Scalar(0), most_alike) : Scalar(0);
    }
    /// The smallest scale of those known; 0: none is.
    [[nodiscard]] Scalar smallest() const noexcept {
        Scalar least_square = 0;
        for (int c = 0; c < SpeedClasses<Scalar>::count; ++c) {
            const bool smaller = least_square == 0 || class_[c].square < least_square;
            least_square = known(c) && smaller ? class_[c].square : least_square;
        }
        using std::sqrt;
        return sqrt(least_square);
    }

    /// Zero, so that a block tells nothing, where its class is not known.
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
    static constexpr Scalar largest = Scalar(1e15); ///< value that is looked at
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
