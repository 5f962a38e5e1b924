// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <functional>

namespace dfdyn::tools {

/// The other parts of a tick, measured in alternation with the tick of model NP with the same number of
/// columns.
struct ModelBench {
    int columns = 0;
    int inputs = 0;
    int physical_parameters = 0;
    TickTimes nonparametric; ///< NP's tick with given columns
    TickTimes features;      ///< computation of the columns from the inputs
    TickTimes kernel;        ///< SPK's tick with given columns
    TickTimes dense;         ///< the same regression with one Cholesky factor for all unknowns
    double kernel_error = 0; ///< of SPK's predictions relative to those of the dense factor in double

    double feature_share() const { return features.median / (features.median + nonparametric.median); }
    double kernel_over_nonparametric() const { return kernel.median / nonparametric.median; }
    double dense_over_kernel() const { return dense.median / kernel.median; }
};

/// Runs with 2d = 500, 12 inputs, 6 outputs, p = 40 rigid-body parameters and two of friction per joint.
/// `dense_ticks`: number of ticks of the dense form; each takes a considerable part of a second.
ModelBench run_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe,
                           const std::function<void(double)>& on_share_done);

/// Runs with few columns and parameters, as a functional test.
ModelBench run_small_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe);

} // namespace dfdyn::tools
