// SPDX-License-Identifier: Apache-2.0
// Two disjoint groups of recordings of one real UR5 (tests/data/ur5_kufieta/PROVENANCE.md), without a load.
#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/support/ur5_runs.hpp"
#include "tools/diagnosis/recordings/several_recordings.hpp"

#include <cmath>

namespace {

using namespace dfdyn::tools;
using Eigen::Index;

SeveralRecordings answer_of(const std::vector<std::string>& runs) {
    DiagnosisOptions options;
    options.outputs = OutputKind::motor_current;
    options.torque_constants = {8.2, 11.4, 9.4, 7, 11, 1.3}; // N·m/A, estimated from No6
    return fit_recordings(dfdyn::tests::ur5(), dfdyn::tests::ur5_runs(runs), options, true);
}

} // namespace

TEST_CASE("disjoint recordings of a real arm agree on friction within their intervals and have no load") {
    const SeveralRecordings first =
        answer_of({"No3_Acc", "No5_Acc_slow_no_disturbance", "No9_Singularity_Free_NoDist",
                   "No7_Acc_slow_Verify_Model_short"});
    const SeveralRecordings second =
        answer_of({"No1", "No4_Acc", "No5_Acc_slow_w_disturbance", "No9_Singularity_Free_WDist"});
    REQUIRE(first.pooled.size() == 4);
    REQUIRE(second.pooled.size() == 4);
    CHECK(first.answer.loads.empty());
    CHECK(second.answer.loads.empty());
    const PooledFit& one = first.answer.fit;
    const PooledFit& other = second.answer.fit;
    for (Index joint = 0; joint < 6; ++joint) {
        CAPTURE(joint);
        const Index viscous = 60 + terms_of_joint * joint + 2;
        for (const Index at : {viscous, viscous + 1}) {
            const double mean = (one.value[at] + other.value[at]) / 2;
            const double apart = std::abs(one.value[at] - other.value[at]);
            CHECK(one.value[at] > 0);
            CHECK(apart < (at == viscous ? 0.35 : 0.15) * mean);
            CHECK(apart < 1.96 * std::hypot(std::sqrt(one.covariance(at, at)), one.spread[at]));
            CHECK(apart < 1.96 * std::hypot(std::sqrt(other.covariance(at, at)), other.spread[at]));
        }
    }
}
