// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/inputs/row_family.hpp"
#include "tools/model/model.hpp"
#include "tools/training/data/lag_window.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// The kernel's inputs xi of the likelihood rows, as a differentiable function of the input's own parameters.
class InputMap {
  public:
    InputMap() = default;
    InputMap(const InputMap&) = delete;
    InputMap& operator=(const InputMap&) = delete;
    virtual ~InputMap() = default;

    virtual Bounds bounds() const = 0;
    virtual Eigen::VectorXd start(int index, NormalSource& random) const = 0;

    /// Returns N x (n k), with element (i, j) of xi in column i k + j. Each column has an arbitrary constant
    /// offset, because the kernel depends on differences only.
    virtual Eigen::MatrixXd inputs(const Eigen::VectorXd& parameters) const = 0;

    /// Returns the gradient with respect to the parameters, from the one with respect to inputs(parameters).
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const Eigen::MatrixXd& input_gradient) const = 0;

    /// Returns the stored form of the input, except for kind, lags and position_noise_bound, which the caller
    /// sets.
    virtual InputModel model(const Eigen::VectorXd& parameters) const = 0;
};

/// Returns the input DF, DFW, DFR or DFSR. `rows`: the likelihood rows; `spread`: the standard deviations
/// that scale the inputs.
std::unique_ptr<InputMap> lag_input(const Eigen::MatrixXd& positions, const RowList& rows, LagSpread spread,
                                    std::unique_ptr<RowFamily> family);

/// Returns the input STD: position, velocity and acceleration with unit standard deviation over `scale_rows`,
/// times the gains 1, a_1, a_2. With `relevance`, log a_j is learned; otherwise a_j is 1. `spread` determines
/// which joints are constant; their inputs have scale 1.
std::unique_ptr<InputMap> derivative_input(const TrainingData& data, const RowList& rows,
                                           const RowList& scale_rows, const LagSpread& spread,
                                           bool relevance);

/// Returns the inputs xi exactly as the product computes them: scale .* (R q_i(t^-)), or scale .* (q, qd,
/// qdd) for STD. rows x (n k).
Eigen::MatrixXd stored_inputs(const InputModel& model, const TrainingData& data, const RowList& rows);

} // namespace dfdyn::tools
