// SPDX-License-Identifier: Apache-2.0
#include "tools/physics/physics_regressor.hpp"

#include "tools/host/host_model.hpp"

#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <numeric>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// All columns selected, unscaled.
PhysicsModel whole_physics(const ChainModel& chain, const std::vector<EffectModel>& effects,
                           const std::vector<double>& output_gain) {
    PhysicsModel physics;
    physics.chain = chain;
    physics.motion.kind = InputKind::STD;
    physics.motion.derivatives = Derivatives::measured;
    physics.effects = effects;
    physics.selected.resize(static_cast<std::size_t>(inertial_parameters * body_count(chain)) +
                            effects.size());
    std::iota(physics.selected.begin(), physics.selected.end(), 0);
    physics.column_scale.assign(physics.selected.size(), 1);
    physics.output_gain = output_gain;
    return physics;
}

template <class Arm>
class PhysicsRegressor final : public Regressor {
  public:
    explicit PhysicsRegressor(const PhysicsModel& physics)
        : constants_(host_physics<double, Arm>(physics)), sizes_(host_physics_sizes<Arm>(physics)) {}

    Index outputs() const override { return sizes_.output_count; }
    Index columns() const override { return sizes_.column_count; }

    void evaluate(const MotionState& state, MatrixXd& values) const override {
        const VectorXd motion = stacked(state);
        RowMajor<double> rows(outputs(), columns());
        HostPhysics::evaluate_rows<Arm>(constants_, sizes_, motion.data(), rows.data());
        values = rows;
    }

    /// By derivatives carried along with the numbers, a few directions at a time: first those of the
    /// velocities, then of the accelerations. Nothing is learned of positions.
    RegressorGradient pull_back(const MotionState& state, const MatrixXd& gradient) const override {
        const Index joints = state.position.size();
        VectorXd total(2 * joints + directions);
        for (Index first = 0; first < 2 * joints; first += directions) {
            total.segment<directions>(first) = slope_along(state, gradient, first);
        }
        return {total.head(joints), total.segment(joints, joints)};
    }

  private:
    static constexpr int directions = 4;
    using Slope = Eigen::Matrix<double, directions, 1>;
    using Dual = Eigen::AutoDiffScalar<Slope>;
    template <class Number>
    using RowMajor = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    static VectorXd stacked(const MotionState& state) {
        VectorXd motion(3 * state.position.size());
        for (Index i = 0; i < state.position.size(); ++i) {
            motion.segment<3>(3 * i) << state.position[i], state.velocity[i], state.acceleration[i];
        }
        return motion;
    }

    /// Derivative of sum(gradient ∘ ψ) along directions number `first` and on.
    Slope slope_along(const MotionState& state, const MatrixXd& gradient, Index first) const {
        const Index joints = state.position.size();
        const VectorXd motion = stacked(state);
        std::vector<Dual> dual(motion.begin(), motion.end());
        for (Index i = first; i < std::min<Index>(first + directions, 2 * joints); ++i) {
            const Index element = 3 * (i % joints) + (i < joints ? 1 : 2);
            dual[static_cast<std::size_t>(element)].derivatives()[i - first] = 1;
        }
        RowMajor<Dual> rows(outputs(), columns());
        HostPhysics::evaluate_rows<Arm>(constants_, sizes_, dual.data(), rows.data());
        Slope total = Slope::Zero();
        for (Index k = 0; k < outputs(); ++k) {
            for (Index c = 0; c < columns(); ++c) {
                total += gradient(k, c) * rows(k, c).derivatives();
            }
        }
        return total;
    }

    HostPhysics::Constants<double, Arm> constants_;
    HostPhysics::Sizes<Arm> sizes_;
};

} // namespace

std::unique_ptr<Regressor> physics_regressor(const ChainModel& chain, const std::vector<EffectModel>& effects,
                                             const std::vector<double>& output_gain) {
    const PhysicsModel physics = whole_physics(chain, effects, output_gain);
    if (chain.sensor) {
        return std::make_unique<PhysicsRegressor<WrenchArm>>(physics);
    }
    return std::make_unique<PhysicsRegressor<TorqueArm>>(physics);
}

} // namespace dfdyn::tools
