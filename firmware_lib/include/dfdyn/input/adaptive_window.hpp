// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <cstdint>

namespace dfdyn {

/// Velocity and acceleration at the newest of a few samples, by the adaptive windowing of F. Janabi-Sharifi,
/// V. Hayward and C.-S. J. Chen, "Discrete-time adaptive windowing for velocity estimation", IEEE Trans.
/// Control Systems Technology 8(6), 2000 (best-fit variant): a least-squares polynomial over the longest
/// window in which it passes within the noise bound of every sample. Fast motion gets a short window and
/// little delay, slow motion a long window and little noise.
///
/// `time` and `value` contain `count` samples, newest first; times decrease and are relative to the newest
/// (time[0] = 0). With fewer than degree + 1 samples the result is 0. Causal. O(count²): the window grows to
/// at most `count`.
template <class Scalar>
class AdaptiveWindow {
  public:
    constexpr AdaptiveWindow(const Scalar* time, const Scalar* value, int stride, int count,
                             Scalar noise_bound) noexcept
        : time_(time), value_(value), stride_(stride), count_(count), noise_bound_(noise_bound) {}

    /// Returns the slope of the longest line that fits, in units of value per time.
    [[nodiscard]] constexpr Scalar velocity() const noexcept { return longest(1).slope; }

    /// Returns the slope of another signal with the same times over the window of that line, so that two
    /// compared signals have the same delay. `stride` and order are those of `value`.
    [[nodiscard]] constexpr Scalar slope_of(const Scalar* other) const noexcept {
        const int length = longest(1).length;
        return length < 2 ? Scalar(0)
                          : AdaptiveWindow(time_, other, stride_, length, noise_bound_).fit(1, length).slope;
    }

    /// Returns the second derivative of the longest parabola that fits, in units of value per time squared.
    [[nodiscard]] constexpr Scalar acceleration() const noexcept { return longest(2).curvature; }

    /// Returns the multiply-adds of both if all samples fit, which is the maximum.
    [[nodiscard]] static constexpr std::int64_t cost(int count) noexcept {
        std::int64_t total = 0;
        for (int length = 2; length <= count; ++length) {
            total += 4 * length + 8; // a line through `length` samples
            // Test of the line; a parabola.
            total += length > 2 ? 4 * length + 8 * length + 9 : 0;
            total += length > 3 ? 4 * length : 0; // test of the parabola
        }
        return total;
    }

  private:
    /// value ≈ mean + slope_at_mean·u + half_curvature·(u² - skew·u - spread), u = time - mean time:
    /// polynomials that are orthogonal over the window, so that single precision suffices.
    struct Fit {
        Scalar mean_time = 0, mean_value = 0;
        Scalar slope_at_mean = 0, half_curvature = 0;
        Scalar skew = 0, spread = 0;
        Scalar slope = 0, curvature = 0; ///< at the newest sample
        int length = 0;                  ///< samples
    };

  public:
    static constexpr std::int64_t fit_bytes = sizeof(Fit); ///< of one polynomial

  private:
    [[nodiscard]] constexpr Fit longest(int degree) const noexcept {
        Fit best;
        for (int length = degree + 1; length <= count_; ++length) {
            const Fit candidate = fit(degree, length);
            // The shortest window interpolates its samples; rounding must not reject it.
            if (length > degree + 1 && !within_noise(candidate, length)) {
                break;
            }
            best = candidate;
        }
        return best;
    }

    /// Returns the value of sample i relative to the newest: exact in floating point if the values are close.
    [[nodiscard]] constexpr Scalar relative(int i) const noexcept { return value_[i * stride_] - value_[0]; }

    [[nodiscard]] constexpr Fit fit(int degree, int length) const noexcept {
        Fit result;
        result.length = length;
        for (int i = 0; i < length; ++i) {
            result.mean_time += time_[i];
            result.mean_value += relative(i);
        }
        result.mean_time /= static_cast<Scalar>(length);
        result.mean_value /= static_cast<Scalar>(length);
        fit_line(result, length);
        if (degree == 2) {
            fit_parabola(result, length);
        }
        const Scalar u = -result.mean_time;
        result.slope = result.slope_at_mean + result.half_curvature * (2 * u - result.skew);
        result.curvature = 2 * result.half_curvature;
        return result;
    }

    constexpr void fit_line(Fit& result, int length) const noexcept {
        Scalar uu = 0;
        Scalar uuu = 0;
        Scalar uv = 0;
        for (int i = 0; i < length; ++i) {
            const Scalar u = time_[i] - result.mean_time;
            uu += u * u;
            uuu += u * u * u;
            uv += u * relative(i);
        }
        result.slope_at_mean = uv / uu;
        result.skew = uuu / uu;
        result.spread = uu / static_cast<Scalar>(length);
    }

    constexpr void fit_parabola(Fit& result, int length) const noexcept {
        Scalar pp = 0;
        Scalar pv = 0;
        for (int i = 0; i < length; ++i) {
            const Scalar p = parabola(result, time_[i] - result.mean_time);
            pp += p * p;
            pv += p * relative(i);
        }
        result.half_curvature = pv / pp;
    }

    static constexpr Scalar parabola(const Fit& result, Scalar u) noexcept {
        return u * u - result.skew * u - result.spread;
    }

    [[nodiscard]] constexpr bool within_noise(const Fit& candidate, int length) const noexcept {
        for (int i = 0; i < length; ++i) {
            const Scalar u = time_[i] - candidate.mean_time;
            const Scalar fitted = candidate.mean_value + candidate.slope_at_mean * u +
                                  candidate.half_curvature * parabola(candidate, u);
            const Scalar error = relative(i) - fitted;
            if (!(error <= noise_bound_ && -error <= noise_bound_)) {
                return false;
            }
        }
        return true;
    }

    const Scalar* time_;
    const Scalar* value_;
    int stride_;
    int count_;
    Scalar noise_bound_;
};

} // namespace dfdyn
