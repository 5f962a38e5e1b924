// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

namespace dfdyn {

/// The last M+1 positions of n joints, newest first: q(t⁻) of the paper (Section V).
///
/// A ring buffer that writes each row twice, M+1 rows apart, so that the window is always one contiguous
/// block: no copying, and no wrap-around for the reader. Push O(n). Memory 2 (M+1) n scalars.
template <class Scalar, int n, int M>
class LagWindow {
  public:
    /// Starts empty. `joints`: n; `lags`: M.
    constexpr LagWindow(Extent<n> joints, Extent<M> lags) noexcept
        : joints_(joints), lags_(lags), rows_(Rows::zeros(extent<size>(2 * (lags + 1) * joints))) {}

    /// Returns the number of rows of a full window: M+1.
    [[nodiscard]] constexpr int capacity() const noexcept { return lags_ + 1; }
    /// Returns whether the window contains M+1 rows.
    [[nodiscard]] constexpr bool full() const noexcept { return filled_ == capacity(); }
    /// Returns the number of rows since the last restart, at most M+1.
    [[nodiscard]] constexpr int filled() const noexcept { return filled_; }

    /// Empties the window; it must fill again.
    constexpr void restart() noexcept {
        filled_ = 0;
        newest_ = 0;
    }

    /// Adds the newest row of n positions.
    constexpr void push(const Scalar* position) noexcept {
        newest_ = newest_ == 0 ? lags_ : newest_ - 1;
        Scalar* row = rows_.data() + newest_ * joints_;
        for (int i = 0; i < joints_; ++i) {
            row[i] = position[i];
            row[i + capacity() * joints_] = position[i];
        }
        filled_ = full() ? filled_ : filled_ + 1;
    }

    /// Returns the row of n positions `lag` samples ago, 0 ≤ lag < filled().
    [[nodiscard]] constexpr const Scalar* row(int lag) const noexcept {
        return rows_.data() + (newest_ + lag) * joints_;
    }

    /// Returns the bytes of the rows.
    [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int lags) noexcept {
        return storage_bytes<Scalar>(std::int64_t{2} * (lags + 1) * joints);
    }

  private:
    static constexpr int size = product(2, product(sum(M, 1), n));
    using Rows = Storage<Scalar, size>;

    [[no_unique_address]] Extent<n> joints_;
    [[no_unique_address]] Extent<M> lags_;
    Rows rows_;
    int newest_ = 0;
    int filled_ = 0;
};

} // namespace dfdyn
