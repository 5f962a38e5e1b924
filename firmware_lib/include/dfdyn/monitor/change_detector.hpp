// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/block_scale.hpp"
#include "dfdyn/storage.hpp"

#include <cmath>

namespace dfdyn {

/// Watches the block means of m normalised innovations for a change, each output and all together.
///
/// Per output a CUSUM (E. S. Page, 1954) of the log likelihood ratio of a block mean x of scale `growth`
/// against its usual one, both of Student's t with ν degrees of freedom, u = x / scale:
///
///     s = ν log(growth) - (ν+1)/2 log((growth² + u²/ν) / (1 + u²/ν)) + log(growth) …
///       = -log(growth) + (ν+1)/2 log((1 + u²/ν) / (1 + u²/(ν growth²)))
///
/// which is at most ν log(growth): no single block raises an alarm. The alarm is at h = log(channels ·
/// `blocks_between_false_alarms`): the mean time between false alarms of such a sum is at least e^h (G.
/// Lorden, "Procedures for reacting to a change in distribution", 1971), as long as tails are not heavier
/// than the t's. Blocks are not independent: with a first-order autocorrelation a, as many as n blocks have
/// the squares of n (1-a²)/(1+a²) independent ones, so that s counts with that factor. The sum over all
/// outputs, which finds what moves several a little, counts half: that bears outputs whose errors go in pairs
/// (by Hölder's inequality).
///
/// The onset of an alarm is where its sum last began to rise. It is over when every output's sum of -s has
/// risen by `quiet`: it was learned, or went away.
///
/// Cost per block: about 100 m operations, a logarithm per output. Memory: 12 (m+1) numbers.
template <class Scalar, int m>
class ChangeDetector {
  public:
    static constexpr Scalar growth = 3;          ///< of the scale, that is looked for
    static constexpr int settling_blocks = 100;  ///< before the first alarm
    static constexpr Scalar quiet = Scalar(3.0); ///< log of the odds for "as usual" at which a change is over

    /// `blocks_between_false_alarms` > 1: their mean, together of all channels.
    ChangeDetector(Extent<m> outputs, Scalar blocks_between_false_alarms) noexcept
        : outputs_(outputs), threshold_(std::log(blocks_between_false_alarms *
                                                 static_cast<Scalar>(outputs + 1))),
          usual_(Storage<BlockScale<Scalar>, m>::zeros(outputs)),
          rising_(Storage<Cusum, sum(m, 1)>::zeros(extent<sum(m, 1)>(outputs + 1))),
          falling_(Storage<Scalar, m>::zeros(outputs)) {}

    /// Takes in the next block's means. True while the alarm is on.
    bool add(const Scalar* means) noexcept {
        Scalar together = 0;
        bool calm = true;
        for (int k = 0; k < outputs_; ++k) {
            const Scalar score = score_of(k, means[k]);
            rise(k, score);
            together += score / 2;
            falling_[k] = std::min(std::max(falling_[k] - score, Scalar(0)), quiet);
            calm = calm && falling_[k] >= quiet;
        }
        rise(outputs_, together);
        settled_ = settled_ < settling_blocks ? settled_ + 1 : settled_;
        decide(calm);
        if (!alarm_) {
            for (int k = 0; k < outputs_; ++k) {
                usual_[k].learn(means[k]);
            }
        }
        return alarm_;
    }

    [[nodiscard]] bool alarm() const noexcept { return alarm_; }
    /// The output whose innovation raised the last alarm; m: all together.
    [[nodiscard]] int channel() const noexcept { return channel_; }
    /// Blocks since the onset of the present alarm, that of the onset included.
    [[nodiscard]] int blocks_since_onset() const noexcept { return since_onset_; }

    /// Takes what goes on to be usual from now on.
    void adopt() noexcept {
        for (BlockScale<Scalar>& usual : usual_) {
            usual.restart();
        }
        settled_ = 0;
        rest();
    }

    [[nodiscard]] const BlockScale<Scalar>& usual(int output) const noexcept { return usual_[output]; }
    [[nodiscard]] Scalar threshold() const noexcept { return threshold_; }

  private:
    struct Cusum {
        Scalar sum;
        int blocks; ///< since it was zero
    };

    [[nodiscard]] Scalar score_of(int k, Scalar mean) const noexcept {
        constexpr Scalar degrees = BlockScale<Scalar>::degrees;
        const Scalar a = usual_[k].autocorrelation();
        const Scalar u = mean / usual_[k].scale();
        const Scalar square = std::min(u * u, Scalar(1e6)) / degrees;
        const Scalar ratio = (1 + square) / (1 + square / (growth * growth));
        const Scalar score = (degrees + 1) / 2 * std::log(ratio) - std::log(growth);
        return score * (1 - a * a) / (1 + a * a);
    }

    void rise(int channel, Scalar score) noexcept {
        Cusum& cusum = rising_[channel];
        cusum.sum = std::max(cusum.sum + score, Scalar(0));
        cusum.blocks = cusum.sum > 0 ? cusum.blocks + 1 : 0;
    }

    void decide(bool calm) noexcept {
        if (alarm_) {
            ++since_onset_;
            if (calm) {
                rest();
            }
            return;
        }
        if (settled_ < settling_blocks) {
            for (Cusum& cusum : rising_) {
                cusum = {};
            }
            return;
        }
        for (int channel = outputs_; channel >= 0; --channel) {
            if (rising_[channel].sum > threshold_) {
                alarm_ = true;
                channel_ = channel;
                since_onset_ = rising_[channel].blocks;
            }
        }
        for (int k = 0; alarm_ && k < outputs_; ++k) {
            falling_[k] = 0;
        }
    }

    void rest() noexcept {
        alarm_ = false;
        for (Cusum& cusum : rising_) {
            cusum = {};
        }
    }

    [[no_unique_address]] Extent<m> outputs_;
    Scalar threshold_;
    Storage<BlockScale<Scalar>, m> usual_;
    Storage<Cusum, sum(m, 1)> rising_;
    Storage<Scalar, m> falling_;
    int settled_ = 0; ///< blocks seen, as far as they are counted
    int since_onset_ = 0;
    int channel_ = 0;
    bool alarm_ = false;
};

} // namespace dfdyn
