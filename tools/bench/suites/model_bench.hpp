// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <functional>

namespace dfdyn::tools {

/// The other parts of a tick, measured in turn with the tick of model NP of as many columns.
struct ModelBench {
    int columns = 0;
    int inputs = 0;
    int physical_parameters = 0;
    TickTimes nonparametric; ///< NP's tick, the columns given
    TickTimes features;      ///< the columns from their inputs
    TickTimes kernel;        ///< SPK's tick, all columns given
    TickTimes dense;         ///< the same regression by one Cholesky factor of all unknowns
    double kernel_error = 0; ///< of SPK's predictions, against those of the dense factor in double

    double feature_share() const { return features.median / (features.median + nonparametric.median); }
    double kernel_over_nonparametric() const { return kernel.median / nonparametric.median; }
    double dense_over_kernel() const { return dense.median / kernel.median; }
};

/// 2d = 500, 12 inputs, 6 outputs, p = 40 rigid-body parameters and two of friction per joint. `dense_ticks`:
/// of the dense form, whose one tick takes a good part of a second.
ModelBench run_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe,
                           const std::function<void(double)>& on_share_done);

/// The same with few columns and parameters, to see that all of it works.
ModelBench run_small_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe);

} // namespace dfdyn::tools
