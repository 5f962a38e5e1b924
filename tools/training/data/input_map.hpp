// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/input_rows.hpp"
#include "tools/training/data/lag_window.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// The kernel's inputs xi of the likelihood rows as a differentiable function of the input's own parameters.
class InputMap {
  public:
    InputMap() = default;
    InputMap(const InputMap&) = delete;
    InputMap& operator=(const InputMap&) = delete;
    virtual ~InputMap() = default;

    virtual Bounds bounds() const = 0;
    virtual Eigen::VectorXd start(int index, NormalSource& random) const = 0;

    /// N x (n k), element (i, j) of xi in column i k + j, up to a constant per column (the kernel sees
    /// differences only).
    virtual Eigen::MatrixXd inputs(const Eigen::VectorXd& parameters) const = 0;

    /// Gradient with respect to the parameters, from the one with respect to inputs(parameters).
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const Eigen::MatrixXd& input_gradient) const = 0;

    /// What is stored of it; kind, lags and position_noise_bound are left to the caller.
    virtual InputModel model(const Eigen::VectorXd& parameters) const = 0;
};

/// DF, DFW, DFR, DFSR. `rows` are the likelihood rows, `spread` the deviations that scale the inputs.
std::unique_ptr<InputMap> lag_input(const Eigen::MatrixXd& positions, const RowList& rows, LagSpread spread,
                                    std::unique_ptr<RowFamily> family);

/// STD: position, velocity and acceleration with unit deviation over `scale_rows`, times gains 1, a_1, a_2,
/// with `relevance` learned as log a_j, else 1. `spread` says which joints are held: their inputs get
/// scale 1.
std::unique_ptr<InputMap> derivative_input(const TrainingData& data, const RowList& rows,
                                           const RowList& scale_rows, const LagSpread& spread,
                                           bool relevance);

/// The inputs xi exactly as the product computes them: scale .* (R q_i(t^-)), or scale .* (q, qd, qdd) for
/// STD. rows x (n k).
Eigen::MatrixXd stored_inputs(const InputModel& model, const TrainingData& data, const RowList& rows);

} // namespace dfdyn::tools
