// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/training_data.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <cmath>

namespace dfdyn::tools {
namespace {

std::string shape(Eigen::Index rows, Eigen::Index columns) {
    return std::to_string(rows) + " x " + std::to_string(columns);
}

void check_shape(const Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index columns,
                 const std::string& what) {
    if (matrix.rows() != rows || matrix.cols() != columns) {
        throw InputError("training data: expected " + what + " of " + shape(rows, columns) + ", found " +
                         shape(matrix.rows(), matrix.cols()));
    }
}

void check_count(std::size_t found, Eigen::Index expected, const std::string& what) {
    if (found != static_cast<std::size_t>(expected)) {
        throw InputError("training data: expected " + std::to_string(expected) + " " + what + ", found " +
                         std::to_string(found));
    }
}

void check_finite(const Eigen::MatrixXd& matrix, const std::string& what) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
            if (!std::isfinite(matrix(row, column))) {
                throw InputError("training data: row " + std::to_string(row) + ", " + what + " " +
                                 std::to_string(column + 1) + ": expected a finite number, found " +
                                 number_text(matrix(row, column)));
            }
        }
    }
}

} // namespace

void check_training_data(const TrainingData& data, InputKind kind) {
    const Eigen::Index rows = data.positions.rows();
    const Eigen::Index joints = data.positions.cols();
    if (joints < 1 || data.outputs.cols() < 1) {
        throw InputError("training data: expected at least one joint and one output, found " +
                         std::to_string(joints) + " and " + std::to_string(data.outputs.cols()));
    }
    check_shape(data.outputs, rows, data.outputs.cols(), "outputs");
    check_count(data.gap_before.size(), rows, "gap flags");
    check_count(data.output_names.size(), data.outputs.cols(), "output names");
    check_finite(data.positions, "position of joint");
    check_finite(data.outputs, "output");
    if (!input_description(kind).uses_derivatives()) {
        return;
    }
    check_shape(data.velocities, rows, joints, "velocities");
    check_shape(data.accelerations, rows, joints, "accelerations");
    check_finite(data.velocities, "velocity of joint");
    check_finite(data.accelerations, "acceleration of joint");
}

} // namespace dfdyn::tools
