// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Number of blocks of time, each predicted by the others. The last pass of all is the trained model's.
inline constexpr std::size_t held_out_blocks = 8;

/// A row with the error of its prediction. `pass`: number of the held-out block, or `held_out_blocks`.
struct PredictedRow {
    std::size_t pass = 0;
    std::int64_t time_ns = 0;
    bool begins = false; ///< does not follow the row before
    std::vector<float> position, error, prediction, standard_deviation;
};

/// Predicts each block of time by a frozen estimator that has learned all others from the prior, and then all
/// rows by the frozen model. Cost: `held_out_blocks` + 1 ticks per row.
std::vector<PredictedRow> calibration_rows(const TrainedModel& model, std::span<const Recording> recordings);

/// Runs a detector over the rows; calls `use(row, detector)` after each.
template <class Use>
void detect(std::span<const PredictedRow> rows, const ContactModel& contact, Use use) {
    ContactWatch watch({contact});
    for (const PredictedRow& row : rows) {
        if (row.begins) {
            watch.interrupt();
        }
        watch.tick(row.time_ns, row.position, row.error, row.prediction, row.standard_deviation);
        use(row, watch.detector());
    }
}

} // namespace dfdyn::tools
