// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/likelihood.hpp"

namespace dfdyn::tools {

/// -2 log marginal likelihood of physics and white noise only (model P): theta = [input's own, physics' own],
/// possibly empty. Refers to `outputs`.
class ParametricLikelihood final : public Likelihood {
  public:
    explicit ParametricLikelihood(const OutputLikelihood& outputs) : outputs_(outputs) {}

    /// O(N m p^2), plus the regressor of every sample.
    std::optional<LikelihoodValue> evaluate(const Eigen::VectorXd& theta) const override {
        auto evidence = outputs_.evaluate(WhiteCovariance(), theta);
        if (!evidence) {
            return std::nullopt;
        }
        return finite_or_nothing({evidence->minus_two_log_likelihood, std::move(evidence->parameter_gradient),
                                  std::move(evidence->output_variance), std::move(evidence->physics)});
    }

  private:
    const OutputLikelihood& outputs_;
};

} // namespace dfdyn::tools
