// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/physics/physics.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/training/physics/regressor.hpp"

#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// The firmware's physics map as the regressor of the training: the columns that `constants` selects, in
/// their order. PhysicsType is a Physics, Arm a Chain.
template <class PhysicsType, class Arm>
class PhysicsRegressor final : public Regressor {
  public:
    using Constants = typename PhysicsType::template Constants<double, Arm>;
    using Sizes = typename PhysicsType::template Sizes<Arm>;

    PhysicsRegressor(Constants constants, const Sizes& sizes)
        : constants_(std::move(constants)), sizes_(sizes) {}

    Eigen::Index outputs() const override { return sizes_.output_count; }
    Eigen::Index columns() const override { return sizes_.column_count; }

    /// Needs the same number of operations as the firmware.
    void evaluate(const MotionState& state, Eigen::MatrixXd& values) const override {
        std::vector<double> xi(static_cast<std::size_t>(3 * state.position.size()));
        for (Eigen::Index i = 0; i < state.position.size(); ++i) {
            double* joint = xi.data() + 3 * i;
            joint[0] = state.position[i];
            joint[1] = state.velocity[i];
            joint[2] = state.acceleration[i];
        }
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        RowMajor psi(outputs(), columns());
        PhysicsType::template evaluate_rows<Arm>(constants_, sizes_, xi.data(), psi.data());
        values = psi;
    }

    /// Uses scalars with `lanes` derivatives at a time. Cost: about n/4 times `lanes` evaluations.
    RegressorGradient pull_back(const MotionState& state, const Eigen::MatrixXd& gradient) const override {
        const Eigen::Index joints = state.position.size();
        RegressorGradient result{Eigen::VectorXd(joints), Eigen::VectorXd(joints)};
        for (Eigen::Index first = 0; first < 2 * joints; first += lanes) {
            const Lanes slopes = pass(state, gradient, first);
            for (Eigen::Index lane = 0; lane < std::min<Eigen::Index>(lanes, 2 * joints - first); ++lane) {
                const Eigen::Index index = first + lane;
                (index % 2 == 0 ? result.velocity : result.acceleration)[index / 2] = slopes[lane];
            }
        }
        return result;
    }

  private:
    static constexpr int lanes = 8;
    using Lanes = Eigen::Matrix<double, lanes, 1>;
    using Dual = Eigen::AutoDiffScalar<Lanes>;

    /// Derivatives with respect to numbers `first` … of (velocity, acceleration) of each joint.
    Lanes pass(const MotionState& state, const Eigen::MatrixXd& gradient, Eigen::Index first) const {
        std::vector<Dual> xi(static_cast<std::size_t>(3 * state.position.size()));
        for (Eigen::Index i = 0; i < state.position.size(); ++i) {
            Dual* joint = xi.data() + 3 * i;
            joint[0] = Dual(state.position[i], Lanes::Zero());
            joint[1] = Dual(state.velocity[i], unit(2 * i - first));
            joint[2] = Dual(state.acceleration[i], unit(2 * i + 1 - first));
        }
        std::vector<Dual> psi(static_cast<std::size_t>(outputs() * columns()));
        PhysicsType::template evaluate_rows<Arm>(constants_, sizes_, xi.data(), psi.data());
        Lanes sum = Lanes::Zero();
        for (Eigen::Index k = 0; k < outputs(); ++k) {
            for (Eigen::Index c = 0; c < columns(); ++c) {
                sum += gradient(k, c) * psi[static_cast<std::size_t>(k * columns() + c)].derivatives();
            }
        }
        return sum;
    }

    static Lanes unit(Eigen::Index lane) {
        return lane < 0 || lane >= lanes ? Lanes(Lanes::Zero()) : Lanes(Lanes::Unit(lane));
    }

    Constants constants_;
    Sizes sizes_;
};

} // namespace dfdyn::tools
