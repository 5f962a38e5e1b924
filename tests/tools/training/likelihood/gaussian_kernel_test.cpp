// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/gaussian_kernel.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <cmath>

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("gaussian_kernel is the Gaussian of the distance") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd inputs = random.matrix(20, 4);
    const MatrixXd kernel = tools::gaussian_kernel(inputs, 1.7);
    for (Eigen::Index s = 0; s < 20; ++s) {
        for (Eigen::Index t = 0; t < 20; ++t) {
            const double distance = (inputs.row(s) - inputs.row(t)).norm();
            CHECK(kernel(s, t) == Approx(std::exp(-distance * distance / (2 * 1.7 * 1.7))).epsilon(1e-12));
        }
    }
    CHECK(kernel.diagonal() == VectorXd::Ones(20));
}

TEST_CASE("gaussian_kernel_pull_back equals finite differences") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd inputs = random.matrix(9, 3);
    MatrixXd weights = random.matrix(9, 9);
    weights = (weights + weights.transpose()).eval();
    const auto of_inputs = [&](const VectorXd& flat) {
        return weights.cwiseProduct(tools::gaussian_kernel(flat.reshaped(9, 3), 1.3)).sum();
    };
    const auto of_log_length = [&](const VectorXd& log_length) {
        return weights.cwiseProduct(tools::gaussian_kernel(inputs, std::exp(log_length[0]))).sum();
    };
    const tools::KernelGradient gradient =
        tools::gaussian_kernel_pull_back(inputs, 1.3, tools::gaussian_kernel(inputs, 1.3), weights);
    const VectorXd flat = inputs.reshaped();
    CHECK(dfdyn::tests::relative_error(gradient.inputs.reshaped(),
                                       dfdyn::tests::differences(of_inputs, flat)) < 1e-7);
    const VectorXd log_length = VectorXd::Constant(1, std::log(1.3));
    CHECK(gradient.log_length_scale ==
          Approx(dfdyn::tests::differences(of_log_length, log_length)[0]).epsilon(1e-7));
}
