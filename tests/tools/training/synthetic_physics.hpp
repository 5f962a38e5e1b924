// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/training/physics/regressor.hpp"

#include <cmath>

namespace dfdyn::tests {

/// Columns like those of mechanics: linear in the accelerations and quadratic in the velocities.
class SyntheticRegressor final : public tools::Regressor {
  public:
    SyntheticRegressor(Eigen::Index joints, Eigen::Index outputs, Eigen::Index columns,
                       tools::NormalSource& random)
        : joints_(joints), outputs_(outputs), columns_(columns), phase_(random.matrix(outputs, columns)) {}

    Eigen::Index outputs() const override { return outputs_; }
    Eigen::Index columns() const override { return columns_; }

    void evaluate(const tools::MotionState& state, Eigen::MatrixXd& values) const override {
        for (Eigen::Index k = 0; k < outputs_; ++k) {
            for (Eigen::Index c = 0; c < columns_; ++c) {
                const Parts parts = parts_of(state, k, c);
                values(k, c) = parts.weight * state.acceleration[parts.joint] +
                               parts.square * state.velocity[parts.joint] * state.velocity[parts.other] +
                               5 * parts.square + parts.weight;
            }
        }
    }

    tools::RegressorGradient pull_back(const tools::MotionState& state,
                                       const Eigen::MatrixXd& gradient) const override {
        tools::RegressorGradient result{Eigen::VectorXd::Zero(joints_), Eigen::VectorXd::Zero(joints_)};
        for (Eigen::Index k = 0; k < outputs_; ++k) {
            for (Eigen::Index c = 0; c < columns_; ++c) {
                const Parts parts = parts_of(state, k, c);
                result.acceleration[parts.joint] += gradient(k, c) * parts.weight;
                result.velocity[parts.joint] += gradient(k, c) * parts.square * state.velocity[parts.other];
                result.velocity[parts.other] += gradient(k, c) * parts.square * state.velocity[parts.joint];
            }
        }
        return result;
    }

  private:
    struct Parts {
        Eigen::Index joint, other;
        double weight, square;
    };

    Parts parts_of(const tools::MotionState& state, Eigen::Index k, Eigen::Index c) const {
        const Eigen::Index joint = c % joints_;
        const Eigen::Index other = (c + k) % joints_;
        return {joint, other, 0.3 * std::cos(state.position[other] + phase_(k, c)),
                std::sin(state.position[joint] + 2 * phase_(k, c))};
    }

    Eigen::Index joints_, outputs_, columns_;
    Eigen::MatrixXd phase_;
};

} // namespace dfdyn::tests
