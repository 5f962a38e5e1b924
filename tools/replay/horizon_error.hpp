// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/runtime_estimator.hpp"

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// The paper's index ε at one time t: per output, Σ (y(t+s) - ŷ(t+s|t))² / Σ y(t+s)², s = 1 … T.
struct HorizonIndex {
    std::size_t tick;            ///< t, as the number of previous calls of `HorizonError::add` and `skip`
    std::vector<double> epsilon; ///< m values; infinite if the output was 0 throughout
    std::vector<double> error_square; ///< m values: Σ (y(t+s) - ŷ(t+s|t))², the numerator of ε
};

/// Computes ε over a horizon of T samples (paper, Section VI): the error of the model learned up to t for the
/// T following samples, given their positions. Stores the weights of the last T models.
class HorizonError {
  public:
    /// `horizon` T ≥ 1, `outputs` m, `weights` the number of weights of all outputs.
    HorizonError(std::size_t horizon, std::size_t outputs, std::size_t weights);

    /// Adds the sample of the last tick of `estimator`. Cost: T predictions and a copy of the weights.
    void add(const RuntimeEstimator& estimator, std::span<const double> measured);

    /// Adds a tick without a prediction: no horizon extends across it.
    void skip();

    /// Begins a recording or a stretch after a gap: no horizon extends across it.
    void interrupt();

    /// Removes the indices of ticks before `tick`.
    void forget_before(std::size_t tick);

    const std::vector<HorizonIndex>& indices() const noexcept { return indices_; }

  private:
    struct Model {
        std::vector<float> weights;
        std::size_t tick;
        std::vector<double> error_square, output_square;
    };

    void add_to(Model& model, const RuntimeEstimator& estimator, std::span<const double> measured);
    void finish_oldest();

    std::size_t horizon_, outputs_, weight_count_;
    std::size_t ticks_ = 0;
    std::deque<Model> models_; ///< oldest first, at most T
    std::vector<float> prediction_;
    std::vector<HorizonIndex> indices_;
};

} // namespace dfdyn::tools
