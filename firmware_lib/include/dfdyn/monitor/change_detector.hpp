// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/block_scale.hpp"
#include "dfdyn/storage.hpp"

#include <cmath>

namespace dfdyn {

/// Watches the block means of m normalised innovations for a change, each output and all together.
///
/// Per output two CUSUMs (E. S. Page, 1954), of the log likelihood ratio of a block mean x whose scale has
/// grown by a factor g - a small one and a large one - against its usual scale, both of Student's t with ν
/// degrees of freedom, u = x / scale:
///
///     s = -log g + (ν+1)/2 log((1 + u²/ν) / (1 + u²/(ν g²)))
///
/// which is at most ν log g: no single block raises an alarm. The alarm is at h = log(sums ·
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
/// Cost per block: about 100 m operations, three logarithms per output. Memory: 15 (m+1) numbers.
template <class Scalar, int m>
class ChangeDetector {
  public:
    static constexpr int growths = 2;
    static constexpr Scalar growth[growths] = {2, 8}; ///< of the scale, that are looked for
    static constexpr int settling_blocks = 100;       ///< before the first alarm
    static constexpr Scalar quiet = Scalar(3.0); ///< log of the odds for "as usual" at which a change is over

    /// `blocks_between_false_alarms` > 1: their mean, together of all channels.
    ChangeDetector(Extent<m> outputs, Scalar blocks_between_false_alarms) noexcept
        : outputs_(outputs),
          threshold_(std::log(blocks_between_false_alarms * static_cast<Scalar>(growths * (outputs + 1)))),
          usual_(Storage<BlockScale<Scalar>, m>::zeros(outputs)),
          rising_(Storage<Cusum, sum(m, 1)>::zeros(extent<sum(m, 1)>(outputs + 1))),
          falling_(Storage<Scalar, m>::zeros(outputs)) {}

    /// Takes in the next block's means. True while the alarm is on.
    bool add(const Scalar* means) noexcept {
        bool calm = true;
        Scalar together[growths] = {};
        for (int k = 0; k < outputs_; ++k) {
            Scalar fall = 0;
            for (int g = 0; g < growths; ++g) {
                const Scalar score = score_of(k, means[k], growth[g]);
                rise(k, g, score);
                together[g] += score / 2;
                fall += score / growths;
            }
            falling_[k] = std::min(std::max(falling_[k] - fall, Scalar(0)), quiet);
            calm = calm && falling_[k] >= quiet;
        }
        for (int g = 0; g < growths; ++g) {
            rise(outputs_, g, together[g]);
        }
        settled_ = settled_ < settling_blocks ? settled_ + 1 : settled_;
        decide(calm);
        for (int k = 0; !alarm_ && k < outputs_; ++k) {
            usual_[k].learn(means[k]);
        }
        return alarm_;
    }

    [[nodiscard]] bool alarm() const noexcept { return alarm_; }
    /// The output whose innovation raised the last alarm; m: all together.
    [[nodiscard]] int channel() const noexcept { return channel_; }
    /// Blocks since the onset of the present alarm, that of the onset included.
    [[nodiscard]] int blocks_since_onset() const noexcept { return since_onset_; }

    /// Begins anew, also while an alarm is on; what is usual stays.
    void restart() noexcept { rest(); }

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
        Scalar sum[growths];
        int blocks[growths]; ///< since it was zero
    };

    [[nodiscard]] Scalar score_of(int k, Scalar mean, Scalar grown) const noexcept {
        constexpr Scalar degrees = BlockScale<Scalar>::degrees;
        const Scalar a = usual_[k].autocorrelation();
        const Scalar u = mean / usual_[k].scale();
        const Scalar square = std::min(u * u, Scalar(1e6)) / degrees;
        const Scalar ratio = (1 + square) / (1 + square / (grown * grown));
        const Scalar score = (degrees + 1) / 2 * std::log(ratio) - std::log(grown);
        return score * (1 - a * a) / (1 + a * a);
    }

    void rise(int channel, int g, Scalar score) noexcept {
        Cusum& cusum = rising_[channel];
        cusum.sum[g] = std::max(cusum.sum[g] + score, Scalar(0));
        cusum.blocks[g] = cusum.sum[g] > 0 ? cusum.blocks[g] + 1 : 0;
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
            for (int g = 0; g < growths; ++g) {
                if (rising_[channel].sum[g] > threshold_) {
                    alarm_ = true;
                    channel_ = channel;
                    since_onset_ = rising_[channel].blocks[g];
                }
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
