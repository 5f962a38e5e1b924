// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/snapshot.hpp"
#include "dfdyn/storage.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn {

/// One prediction from those of several estimators ("members") of the same m outputs, weighted for each
/// output by how well each member predicted it lately: in inverse proportion to the square of its mean square
/// error over about `memory` samples. A model that is right at once but never quite, as physics is, and one
/// that learns to do better, as features do, then need no choice between them.
///
/// After J. M. Bates and C. W. J. Granger, "The combination of forecasts" (1969), whose weights are in
/// inverse proportion to the mean square error itself; its square, and a memory of 100 samples, were chosen
/// by trial on a measured and a simulated arm. Weights are in [0, 1] and sum to 1, so that the combination of
/// finite predictions lies among them. An error counts for at most a hundred times the best member's: an
/// absurd one is forgotten within five memories.
///
///     for each member j: estimate[j] = estimator[j].tick(sample, budget);   // predictions into one table
///     combination.combine(predictions, prediction);
///     if every estimate[j].status.learned(): combination.learn(predictions, sample.output.data());
///
/// Cost: learn 8 c m, combine c m multiply-adds for c members; 2 c m + 2 scalars. Never allocates.
template <class Scalar, int members, int m>
class ForecastCombination {
  public:
    /// `memory`: samples, ≥ 1; a smaller one counts as 1.
    constexpr ForecastCombination(Extent<members> member_count, Extent<m> output_count,
                                  Scalar memory) noexcept
        : members_(member_count), outputs_(output_count), memory_(memory > 1 ? memory : 1),
          mean_square_(Table::zeros(extent<size>(member_count * output_count))), weights_(mean_square_) {
        restart();
    }

    /// All members count alike, until they have been seen to predict.
    constexpr void restart() noexcept {
        samples_ = 0;
        std::fill(mean_square_.begin(), mean_square_.end(), least);
        std::fill(weights_.begin(), weights_.end(), 1 / static_cast<Scalar>(members_));
    }

    /// `from`: a value of each output from each member, member by member; `to`: m values. Takes predictions,
    /// and their standard deviations, as of members whose errors go together.
    constexpr void combine(const Scalar* from, Scalar* to) const noexcept {
        for (int k = 0; k < outputs_; ++k) {
            Scalar sum = 0;
            for (int j = 0; j < members_; ++j) {
                sum += weights_[at(j, k)] * from[at(j, k)];
            }
            to[k] = sum;
        }
    }

    /// Takes in how the members' predictions of a sample that they learned compare with its m outputs.
    constexpr void learn(const Scalar* predictions, const Scalar* measured) noexcept {
        samples_ = samples_ < memory_ ? samples_ + 1 : memory_;
        for (int k = 0; k < outputs_; ++k) {
            const Scalar most = samples_ > 1 ? std::min(outlier * best_of(k), largest) : largest;
            for (int j = 0; j < members_; ++j) {
                Scalar& mean = mean_square_[at(j, k)];
                const Scalar now = square(predictions[at(j, k)] - measured[k], most);
                mean = std::clamp(mean + (now - mean) / samples_, least, largest);
            }
            weigh(k);
        }
    }

    /// Of each member for each output, member by member.
    [[nodiscard]] constexpr const Scalar* weights() const noexcept { return weights_.data(); }

    [[nodiscard]] std::size_t snapshot_bytes() const noexcept { return dfdyn::snapshot_bytes(*this); }

    /// Writes what has been learned to the front of `buffer`, of at least `snapshot_bytes()`.
    [[nodiscard]] SnapshotResult snapshot(std::span<std::byte> buffer) const noexcept {
        return write_snapshot(*this, identity(), buffer);
    }

    /// Restores a snapshot of a combination of as many members and outputs, whole or not at all.
    [[nodiscard]] SnapshotResult restore(std::span<const std::byte> buffer) noexcept {
        const SnapshotResult result = read_snapshot(*this, identity(), buffer);
        for (int k = 0; k < outputs_; ++k) {
            weigh(k);
        }
        return result;
    }

    template <class Self, class Visitor>
    static void visit_state(Self& self, Visitor& visitor) noexcept {
        visitor.ranged(self.samples_, Scalar(0), self.memory_);
        for (auto& mean : self.mean_square_) {
            visitor.ranged(mean, least, largest);
        }
    }

  private:
    static constexpr int size = product(members, m);
    static constexpr Scalar least = Scalar(1e-30);  ///< mean square error: none is better than this …
    static constexpr Scalar largest = Scalar(1e30); ///< … nor worse than this
    static constexpr Scalar outlier = Scalar(1e4);  ///< times the best: no single square counts for more
    using Table = Storage<Scalar, size>;

    [[nodiscard]] constexpr int at(int member, int output) const noexcept {
        return member * outputs_ + output;
    }

    /// At most `most`, also of what is no number.
    [[nodiscard]] static constexpr Scalar square(Scalar error, Scalar most) noexcept {
        const Scalar value = error * error;
        return value < most ? std::max(value, least) : most;
    }

    /// The least mean square error of the output.
    [[nodiscard]] constexpr Scalar best_of(int output) const noexcept {
        Scalar best = largest;
        for (int j = 0; j < members_; ++j) {
            best = std::min(best, mean_square_[at(j, output)]);
        }
        return best;
    }

    [[nodiscard]] std::uint32_t identity() const noexcept {
        return (static_cast<std::uint32_t>(members_) << 16U) + static_cast<std::uint32_t>(outputs_);
    }

    constexpr void weigh(int output) noexcept {
        const Scalar best = best_of(output);
        Scalar sum = 0;
        for (int j = 0; j < members_; ++j) {
            const Scalar ratio = best / mean_square_[at(j, output)];
            weights_[at(j, output)] = ratio * ratio;
            sum += ratio * ratio;
        }
        for (int j = 0; j < members_; ++j) {
            weights_[at(j, output)] /= sum;
        }
    }

    [[no_unique_address]] Extent<members> members_;
    [[no_unique_address]] Extent<m> outputs_;
    Scalar memory_;
    Scalar samples_ = 0; ///< that the means are over, at most the memory
    Table mean_square_;
    Table weights_;
};

} // namespace dfdyn
