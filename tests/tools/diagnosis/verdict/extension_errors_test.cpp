// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/extension_errors.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/numerics/root_mean_square.hpp"

#include <cmath>
#include <memory>
#include <random>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::VectorXd;

double deviation_of_series(const VectorXd& series) {
    return std::sqrt((series.array() - series.mean()).square().mean());
}

} // namespace

TEST_CASE("errors are reported over all rows and over the rows in which a joint moves") {
    DFDYN_SEEDED_ENGINE(engine);
    auto signals = std::make_shared<DiagnosisSignals>(signals_of(ur5(), OutputKind::motor_current));
    const Index rows = signals->rows();
    const Index standing = rows / 4;
    signals->measured.weight.setOnes(rows, 6);
    signals->measured.weight.col(0).tail(standing).setZero();
    signals->measured.weight.col(2).setZero();
    DiagnosisWork work;
    work.signals = signals;
    work.torque_gains = VectorXd::LinSpaced(6, 0.1, 0.2); // A/(N·m)
    // The cause explains all of the residual while joint 1 moves, and twice the residual while it is at rest.
    const VectorXd cause = random_series(*signals, engine);
    VectorXd missed = 3 * cause;
    missed.tail(standing) /= 2;
    work.measured = signals->nominal;
    work.measured.col(0) += missed;
    const FittedEffects fitted_effects =
        fitted_effects_of({of_one_column("coulomb_friction", "joint1", cause)}, 1, 3 * cause);

    measure_from(work, rows / 2, fitted_effects);

    const Index count = rows - rows / 2;
    const Index moving = count - standing;
    const Diagnosis& diagnosis = work.diagnosis;
    CHECK(diagnosis.nominal.rms[0] == Approx(0.1 * root_mean_square(missed.tail(count))));
    const double left = std::sqrt(missed.tail(standing).squaredNorm() / static_cast<double>(count));
    CHECK(diagnosis.extended.rms[0] == Approx(0.1 * left));
    const VectorXd measured = work.measured.col(0).tail(count);
    CHECK(diagnosis.nominal.nrmse[0] ==
          Approx(root_mean_square(missed.tail(count)) / deviation_of_series(measured)));
    CHECK(diagnosis.nominal.moving_nrmse[0] == Approx(root_mean_square(missed.tail(count).head(moving)) /
                                                      deviation_of_series(measured.head(moving))));
    CHECK(diagnosis.extended.moving_nrmse[0] < 1e-9);
    CHECK(diagnosis.standstill_share[0] ==
          Approx(static_cast<double>(standing) / static_cast<double>(count)));
    CHECK(diagnosis.standstill_share[1] == 0);
    CHECK(diagnosis.standstill_share[2] == 1);
    CHECK(std::isnan(diagnosis.nominal.moving_nrmse[2]));
}
