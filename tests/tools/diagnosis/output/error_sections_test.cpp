// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/error_sections.hpp"

#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <random>

namespace error_sections_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::VectorXd;

TEST_CASE("the spectrum of an error has its power per bin and ends where the output no longer answers") {
    DFDYN_SEEDED_ENGINE(engine);
    MeasuredMotion measured = dfdyn::tests::swing(1);
    measured.response_bandwidth_hz = VectorXd::Constant(1, 5);
    std::normal_distribution<double> normal;
    VectorXd error(measured.time_s.size()); // slow, as the error of friction
    double level = 0;
    for (double& value : error) {
        level = 0.99 * level + normal(engine);
        value = level;
    }
    const SpectralRows rows(measured);
    const ChartCurve curve = error_spectrum(rows, "simulated", error, 0);
    REQUIRE_FALSE(curve.x.empty());
    CHECK(curve.x.back() <= 5);
    CHECK(curve.x.back() > 4.5);
    double power = 0;
    for (const double amplitude : curve.y) {
        power += amplitude * amplitude;
    }
    CHECK(power * rows.filled(0).sum() == Approx(rows.analyse(error, 0).squaredNorm()));
}

} // namespace error_sections_test
