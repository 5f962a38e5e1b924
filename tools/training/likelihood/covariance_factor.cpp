// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/covariance_factor.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::Lower;
using Eigen::MatrixXd;
using Block = Eigen::Ref<MatrixXd>;

constexpr Index leaf_size = 48; // smaller blocks are faster without recursion

/// L -> L^-1 in place, lower triangles: [A 0; B D]^-1 = [A^-1 0; -D^-1 B A^-1 D^-1].
void invert_lower(Block matrix) {
    const Index size = matrix.rows();
    if (size <= leaf_size) {
        const MatrixXd inverse = matrix.triangularView<Lower>().solve(MatrixXd::Identity(size, size));
        matrix.triangularView<Lower>() = inverse;
        return;
    }
    const Index half = size / 2;
    const Index rest = size - half;
    Block a = matrix.topLeftCorner(half, half);
    Block d = matrix.bottomRightCorner(rest, rest);
    invert_lower(a);
    invert_lower(d);
    const MatrixXd product = d.triangularView<Lower>() * matrix.bottomLeftCorner(rest, half);
    matrix.bottomLeftCorner(rest, half).noalias() = -product * a.triangularView<Lower>();
}

/// L -> L' L in place, lower triangle: [A 0; B D] -> [A'A + B'B .; D'B D'D].
void square_lower(Block matrix) {
    const Index size = matrix.rows();
    if (size <= leaf_size) {
        const MatrixXd lower = matrix.triangularView<Lower>();
        matrix.triangularView<Lower>() = lower.transpose() * lower;
        return;
    }
    const Index half = size / 2;
    const Index rest = size - half;
    Block a = matrix.topLeftCorner(half, half);
    Block d = matrix.bottomRightCorner(rest, rest);
    const MatrixXd b = matrix.bottomLeftCorner(rest, half);
    square_lower(a);
    a.selfadjointView<Lower>().rankUpdate(b.transpose());
    matrix.bottomLeftCorner(rest, half).noalias() = d.triangularView<Lower>().transpose() * b;
    square_lower(d);
}

} // namespace

std::optional<CovarianceFactor> CovarianceFactor::of(MatrixXd covariance) {
    const Eigen::LLT<Eigen::Ref<MatrixXd>> in_place(covariance);
    if (in_place.info() != Eigen::Success) {
        return std::nullopt;
    }
    CovarianceFactor factor(std::move(covariance));
    if (!std::isfinite(factor.log_determinant())) {
        return std::nullopt;
    }
    return factor;
}

double CovarianceFactor::log_determinant() const { return 2 * lower_.diagonal().array().log().sum(); }

MatrixXd CovarianceFactor::solve(const MatrixXd& right_hand_sides) const {
    const MatrixXd half = lower_.triangularView<Lower>().solve(right_hand_sides);
    return lower_.triangularView<Lower>().transpose().solve(half);
}

MatrixXd CovarianceFactor::inverse() const {
    MatrixXd inverse = lower_;
    invert_lower(inverse);
    square_lower(inverse);
    inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
    return inverse;
}

} // namespace dfdyn::tools
