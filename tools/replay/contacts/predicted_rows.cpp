// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/predicted_rows.hpp"

#include "tools/replay/recorded_rows.hpp"

namespace dfdyn::tools {

namespace {

/// Appends the rows from `first` to `last` that are predicted, without learning.
void predict_rows(RuntimeEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
                  std::size_t last, std::size_t pass, std::vector<PredictedRow>& predicted) {
    bool follows = false;
    tick_rows(estimator, recordings, first, last, Budget::predict_only(),
              [&](const MeasuredSample& sample, const Tick& tick, bool begins) {
                  follows = follows && !begins && tick.status.estimated();
                  if (tick.status.estimated()) { // as in the firmware, also at the model's bound
                      predicted.push_back({pass,
                                           sample.time_ns,
                                           !follows,
                                           {sample.position.begin(), sample.position.end()},
                                           prediction_errors(sample, tick),
                                           {tick.prediction.begin(), tick.prediction.end()},
                                           {tick.standard_deviation.begin(), tick.standard_deviation.end()}});
                      follows = true;
                  }
              });
}

void learn_rows_of(RuntimeEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
                   std::size_t last) {
    tick_rows(estimator, recordings, first, last, Budget::unlimited(),
              [](const MeasuredSample&, const Tick&, bool) {});
}

} // namespace

std::vector<PredictedRow> calibration_rows(const TrainedModel& model, std::span<const Recording> recordings) {
    const std::size_t rows = total_rows(recordings);
    std::vector<PredictedRow> predicted;
    for (std::size_t block = 0; block < held_out_blocks; ++block) {
        const std::size_t first = rows * block / held_out_blocks;
        const std::size_t last = rows * (block + 1) / held_out_blocks;
        const auto estimator = make_estimator(model, true);
        learn_rows_of(*estimator, recordings, 0, first);
        learn_rows_of(*estimator, recordings, last, rows);
        predict_rows(*estimator, recordings, first, last, block, predicted);
    }
    predict_rows(*make_estimator(model, false), recordings, 0, rows, held_out_blocks, predicted);
    return predicted;
}

} // namespace dfdyn::tools
