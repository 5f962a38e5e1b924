// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/dependence_candidates.hpp"

#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/signals/smooth_functions.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Prior log-odds of a named cause against an unnamed one that explains as much.
constexpr double unnamed_penalty = 4;

/// Inputs on which outputs may depend: the motion of one joint and functions of it.
struct JointInputs {
    std::string position_name, velocity_name;
    Eigen::VectorXd velocity, direction;
    std::vector<Eigen::VectorXd> of_position;

    JointInputs(const DiagnosisSignals& signals, Eigen::Index joint)
        : position_name("q" + std::to_string(joint + 1)), velocity_name("qd" + std::to_string(joint + 1)),
          velocity(signals.measured.motion.velocity.col(joint)), direction(signals.direction(joint)),
          of_position(harmonics(signals.measured.motion.position.col(joint), 5)) {}
};

/// Candidate for the dependence of one output on some inputs.
class Dependence {
  public:
    /// `largest`: limit of its rms.
    Dependence(Eigen::Index output, double largest, std::vector<std::string> inputs)
        : output_(output), largest_(largest) {
        candidate_.where = place_text(PlaceKind::output, static_cast<std::size_t>(output));
        candidate_.inputs = std::move(inputs);
        for (const std::string& input : candidate_.inputs) {
            candidate_.detail += input;
        }
        candidate_.evidence_offset = unnamed_penalty;
    }

    void add_function(const Eigen::VectorXd& series) {
        candidate_.columns.push_back(on_output(output_, series));
    }
    void add_shape(std::vector<std::size_t> columns) {
        Eigen::MatrixXd functions(candidate_.columns.front().parts.front().series.size(),
                                  static_cast<Eigen::Index>(columns.size()));
        for (std::size_t i = 0; i < columns.size(); ++i) {
            functions.col(static_cast<Eigen::Index>(i)) = candidate_.columns[columns[i]].parts.front().series;
        }
        const Eigen::MatrixXd squares =
            functions.transpose() * functions / static_cast<double>(functions.rows());
        const auto allowed = [squares, most = largest_ * largest_](const Eigen::VectorXd& coefficients) {
            return coefficients.dot(squares * coefficients) <= most;
        };
        candidate_.shapes.push_back({std::move(columns), allowed, 0});
    }
    Candidate take() { return std::move(candidate_); }

  private:
    Eigen::Index output_;
    double largest_;
    Candidate candidate_;
};

Candidate of_position(Eigen::Index output, double largest, const JointInputs& joint) {
    Dependence result(output, largest, {joint.position_name});
    for (const Eigen::VectorXd& function : joint.of_position) {
        result.add_function(function);
    }
    result.add_shape({0, 1, 2, 3});
    result.add_shape({0, 1, 2, 3, 4, 5});
    result.add_shape({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    return result.take();
}

/// `own`: only functions that are equal in both directions, because friction of the output's own joint has a
/// name.
Candidate of_velocity(Eigen::Index output, double largest, const JointInputs& joint, bool own) {
    Dependence result(output, largest, {joint.velocity_name});
    result.add_function(joint.velocity.cwiseAbs2());
    result.add_function(joint.velocity.cwiseAbs());
    result.add_function(joint.velocity);
    result.add_function(joint.direction);
    result.add_shape({0});
    result.add_shape({1});
    if (!own) {
        result.add_shape({2});
        result.add_shape({3});
        result.add_shape({2, 3});
    }
    return result.take();
}

/// Friction of a joint that depends on its position.
Candidate of_position_and_velocity(Eigen::Index output, double largest, const JointInputs& joint) {
    Dependence result(output, largest, {joint.position_name, joint.velocity_name});
    for (const Eigen::VectorXd& friction : {joint.velocity, joint.direction}) {
        for (std::size_t i = 0; i < 4; ++i) {
            result.add_function(friction.cwiseProduct(joint.of_position[i]));
        }
    }
    result.add_shape({0, 1});
    result.add_shape({4, 5});
    result.add_shape({0, 1, 2, 3});
    result.add_shape({4, 5, 6, 7});
    return result.take();
}

} // namespace

std::vector<Candidate> dependence_candidates(const DiagnosisSignals& signals,
                                             const Eigen::MatrixXd& unexplained) {
    constexpr double margin = 1.5;
    std::vector<Candidate> result;
    for (Eigen::Index number = 0; number < static_cast<Eigen::Index>(signals.joints()); ++number) {
        const JointInputs joint(signals, number);
        for (Eigen::Index output = 0; output < signals.outputs(); ++output) {
            const double largest = margin * root_mean_square(unexplained.col(output));
            const bool own = !signals.wrench() && output == number;
            result.push_back(of_position(output, largest, joint));
            result.push_back(of_velocity(output, largest, joint, own));
            if (own) {
                result.push_back(of_position_and_velocity(output, largest, joint));
            }
        }
    }
    return result;
}

} // namespace dfdyn::tools
