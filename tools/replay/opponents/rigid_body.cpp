// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/opponents/rigid_body.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/numerics/to_vector.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/model/effects.hpp"
#include "tools/robot/dynamics/friction_direction.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/motion.hpp"
#include "tools/training/physics/column_selection.hpp"
#include "tools/training/physics/parameter_sizes.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double column_threshold = 1e-3; ///< of select_columns(), as in training
constexpr std::size_t most_fitted_rows = 20000;
constexpr Index friction_terms = 3; ///< per output: viscous, dry, constant

/// Columns of one output: those of the rigid body in N·m (N), then the friction terms.
class MotionColumns {
  public:
    MotionColumns(const ChainModel& chain, double sign_velocity)
        : rigid_body_(
              robot_regressor(chain, {}, std::vector<double>(chain.sensor ? 6 : chain.joints.size(), 1))),
          wrench_(chain.sensor.has_value()), sign_velocity_(sign_velocity) {}

    Index outputs() const { return rigid_body_->outputs(); }
    Index inertial() const { return rigid_body_->columns(); }

    /// Writes m x (inertial() + friction_terms).
    void evaluate(const RobotMotion& motion, Index row, MatrixXd& values) {
        rigid_body_->evaluate({motion.position.row(row).transpose(), motion.velocity.row(row).transpose(),
                               motion.acceleration.row(row).transpose()},
                              psi_);
        values.setZero(outputs(), inertial() + friction_terms);
        values.leftCols(inertial()) = psi_;
        values.rightCols<1>().setOnes();
        if (!wrench_) {
            const VectorXd velocity = motion.velocity.row(row).transpose();
            values.col(inertial()) = velocity;
            values.col(inertial() + 1) = friction_direction(velocity, sign_velocity_);
        }
    }

  private:
    std::unique_ptr<Regressor> rigid_body_;
    bool wrench_;
    double sign_velocity_;
    MatrixXd psi_;
};

/// Triangular factor of the QR decomposition of rows that are added one by one: an equivalent least-squares
/// problem with one row per column.
class TriangularFactor {
  public:
    explicit TriangularFactor(Index columns) : rows_(block + columns, columns) {}

    void add(const Eigen::RowVectorXd& row) {
        if (filled_ == rows_.rows()) {
            reduce();
        }
        rows_.row(filled_++) = row;
    }

    MatrixXd value() {
        reduce();
        return rows_.topRows(filled_);
    }

  private:
    static constexpr Index block = 400;

    void reduce() {
        const MatrixXd reduced = triangular_factor(rows_.topRows(filled_));
        filled_ = reduced.rows();
        rows_.topRows(filled_) = reduced;
    }

    MatrixXd rows_;
    Index filled_ = 0;
};

/// The training rows, output by output: the triangular factor of [columns of MotionColumns, measured].
struct ReducedRows {
    std::vector<MatrixXd> of_output;
    double count = 0; ///< rows of each output
};

ReducedRows reduce_rows(MotionColumns& columns, std::span<const Recording> recordings) {
    const std::size_t every = (total_rows(recordings) + most_fitted_rows - 1) / most_fitted_rows;
    const Index width = columns.inertial() + friction_terms;
    std::vector<TriangularFactor> factors(static_cast<std::size_t>(columns.outputs()),
                                          TriangularFactor(width + 1));
    ReducedRows result;
    MatrixXd values;
    Eigen::RowVectorXd line(width + 1);
    for (const Recording& recording : recordings) {
        const SampledMotion sampled = sampled_motion(recording, rigid_body_window(recordings));
        for (std::size_t row = 0; row < sampled.valid.size(); row += every) {
            if (sampled.valid[row] == 0) {
                continue;
            }
            const auto at = static_cast<Index>(row);
            columns.evaluate(sampled.all.motion, at, values);
            for (Index k = 0; k < columns.outputs(); ++k) {
                line << values.row(k), sampled.all.outputs(at, k);
                factors[static_cast<std::size_t>(k)].add(line);
            }
            result.count += 1;
        }
    }
    for (TriangularFactor& factor : factors) {
        result.of_output.push_back(factor.value());
    }
    return result;
}

/// Solves the least-squares problem for `right` with the independent columns; returns 0 for the others.
/// `scale` converts rows to units of the outputs' standard deviations, for `sizes` as in select_columns().
VectorXd solve(const MatrixXd& columns, const VectorXd& right, double scale, const VectorXd& sizes) {
    const std::vector<Index> chosen = select_columns(scale * columns, column_threshold, sizes).columns;
    const VectorXd found = least_squares(columns(Eigen::all, chosen), right);
    VectorXd solution = VectorXd::Zero(columns.cols());
    for (Index i = 0; i < found.size(); ++i) {
        solution[chosen[static_cast<std::size_t>(i)]] = found[i];
    }
    return solution;
}

/// Fits the robot file's inertia: each output to its nominal torque and its friction terms.
RigidBodyFit fit_nominal(const ReducedRows& rows, const VectorXd& nominal, double sign_velocity) {
    RigidBodyFit fit{false, sign_velocity, {}, to_vector(nominal), {}};
    for (const MatrixXd& factor : rows.of_output) {
        MatrixXd columns(factor.rows(), 1 + friction_terms);
        columns << factor.leftCols(nominal.size()) * nominal,
            factor.middleCols(nominal.size(), friction_terms);
        const VectorXd solution = solve(columns, factor.rightCols<1>(), 1, {});
        fit.output_gain.push_back(solution[0]);
        fit.friction.insert(fit.friction.end(), solution.begin() + 1, solution.end());
    }
    return fit;
}

/// All outputs' parameters in one problem: the inertia, then the friction terms of each output.
class JointProblem {
  public:
    JointProblem(const ReducedRows& rows, const std::vector<double>& output_gain, Index inertial)
        : rows_(rows), gain_(output_gain), inertial_(inertial),
          width_(inertial + friction_terms * static_cast<Index>(output_gain.size())) {}

    /// `deviation`: m, divisors of the outputs.
    VectorXd solution(const VectorXd& deviation, const VectorXd& sizes) const {
        MatrixXd columns(0, width_);
        VectorXd right(0);
        for (Index k = 0; k < deviation.size(); ++k) {
            const Index before = columns.rows();
            const Index added = factor(k).rows();
            columns.conservativeResize(before + added, Eigen::NoChange);
            right.conservativeResize(before + added);
            columns.bottomRows(added) = columns_of(k) / deviation[k];
            right.tail(added) = factor(k).rightCols<1>() / deviation[k];
        }
        const double all = rows_.count * static_cast<double>(deviation.size());
        return solve(columns, right, std::sqrt(static_cast<double>(right.size()) / all), sizes);
    }

    /// Root mean square of each output's residual for `parameters`; positive even for an exact fit.
    VectorXd errors(const VectorXd& parameters) const {
        VectorXd result(static_cast<Index>(gain_.size()));
        for (Index k = 0; k < result.size(); ++k) {
            result[k] = (columns_of(k) * parameters - factor(k).rightCols<1>()).norm();
        }
        result /= std::sqrt(rows_.count);
        return result.cwiseMax(std::max(1e-9 * result.maxCoeff(), 1e-15));
    }

    Index width() const { return width_; }

  private:
    const MatrixXd& factor(Index output) const { return rows_.of_output[static_cast<std::size_t>(output)]; }

    MatrixXd columns_of(Index output) const {
        MatrixXd columns = MatrixXd::Zero(factor(output).rows(), width_);
        columns.leftCols(inertial_) =
            gain_[static_cast<std::size_t>(output)] * factor(output).leftCols(inertial_);
        columns.middleCols(inertial_ + friction_terms * output, friction_terms) =
            factor(output).middleCols(inertial_, friction_terms);
        return columns;
    }

    const ReducedRows& rows_;
    const std::vector<double>& gain_;
    Index inertial_, width_;
};

/// Returns the largest plausible magnitudes of JointProblem's parameters for the robot's size.
VectorXd sizes_of(const Robot& robot, const ChainModel& chain, const std::vector<double>& output_gain,
                  double sign_velocity) {
    const std::vector<std::string> names =
        chain.sensor
            ? std::vector<std::string>(friction_terms, effect_kinds::ft_bias.name)
            : std::vector<std::string>{effect_kinds::viscous_friction.name,
                                       effect_kinds::coulomb_friction.name, effect_kinds::torque_offset.name};
    VectorXd sizes = parameter_sizes(robot, chain, {});
    const Index inertial = sizes.size();
    sizes.conservativeResize(inertial + friction_terms * static_cast<Index>(output_gain.size()));
    for (Index term = 0; term < friction_terms; ++term) {
        const auto effects = effect_models({names[static_cast<std::size_t>(term)]}, chain, sign_velocity);
        const VectorXd largest = parameter_sizes(robot, chain, effects).tail(sizes.size() - inertial);
        for (std::size_t k = 0; k < output_gain.size(); ++k) {
            sizes[inertial + friction_terms * static_cast<Index>(k) + term] =
                output_gain[k] * largest[static_cast<Index>(k)];
        }
    }
    return sizes;
}

RigidBodyFit fit_identified(const JointProblem& problem, const VectorXd& sizes, double sign_velocity,
                            const std::vector<double>& output_gain) {
    const VectorXd spread = problem.errors(VectorXd::Zero(problem.width()));
    const VectorXd unweighted = problem.solution(spread, sizes);
    const VectorXd parameters = problem.solution(problem.errors(unweighted), sizes);
    const Index friction = friction_terms * static_cast<Index>(output_gain.size());
    return {true, sign_velocity, output_gain,
            to_vector(VectorXd(parameters.head(problem.width() - friction))),
            to_vector(VectorXd(parameters.tail(friction)))};
}

} // namespace

std::vector<RigidBodyFit> fit_rigid_body(const Robot& robot, const ChainModel& chain,
                                         const std::vector<double>& output_gain, double sign_velocity,
                                         std::span<const Recording> recordings) {
    MotionColumns columns(chain, sign_velocity);
    const ReducedRows rows = reduce_rows(columns, recordings);
    if (rows.count == 0) {
        return {};
    }
    const OutputKind outputs = chain.sensor ? OutputKind::wrench : OutputKind::joint_torque;
    const JointProblem problem(rows, output_gain, columns.inertial());
    return {fit_nominal(rows, nominal_parameters(robot, outputs), sign_velocity),
            fit_identified(problem, sizes_of(robot, chain, output_gain, sign_velocity), sign_velocity,
                           output_gain)};
}

const PhysicsModel* rigid_body_of(std::span<const TrainedModel> models) {
    const auto found = std::ranges::find_if(models, [](const TrainedModel& model) {
        return model.physics && !model.physics->rigid_body.empty();
    });
    return found == models.end() ? nullptr : &*found->physics;
}

Forecasts rigid_body_forecasts(const RigidBodyFit& fit, const ChainModel& chain, const Recording& recording) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, friction_terms, Eigen::RowMajor>;
    MotionColumns columns(chain, fit.sign_velocity);
    const Index outputs = columns.outputs();
    const Eigen::Map<const VectorXd> gain(fit.output_gain.data(), outputs);
    const Eigen::Map<const VectorXd> inertia(fit.inertia.data(), columns.inertial());
    const Eigen::Map<const RowMajor> friction(fit.friction.data(), outputs, friction_terms);
    Forecasts forecasts(static_cast<std::size_t>(outputs) * recording.row_count(),
                        std::numeric_limits<double>::quiet_NaN());
    if (recording.row_count() < 2) {
        return forecasts;
    }
    const SampledMotion sampled = sampled_motion(recording, rigid_body_window(std::span(&recording, 1)));
    MatrixXd values;
    for (std::size_t row = 0; row < sampled.valid.size(); ++row) {
        if (sampled.valid[row] == 0) {
            continue;
        }
        const auto at = static_cast<Index>(row);
        columns.evaluate(sampled.all.motion, at, values);
        const VectorXd torque = values.leftCols(columns.inertial()) * inertia;
        Eigen::Map<VectorXd>(forecasts.data() + outputs * at, outputs) =
            gain.cwiseProduct(torque) +
            values.rightCols<friction_terms>().cwiseProduct(friction).rowwise().sum();
    }
    return forecasts;
}

} // namespace dfdyn::tools
