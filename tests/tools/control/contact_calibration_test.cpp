// SPDX-License-Identifier: Apache-2.0
// A loop that measures its limits of contacts during operation. Its learner follows the reference more
// accurately than the loop that recorded the training.
#include "tests/support/catch.hpp"
#include "tests/tools/control/commissioned_model.hpp"
#include "tests/tools/control/test_arms.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/report/loop_summary.hpp"
#include "tools/replay/contacts/contact_limits.hpp"

#include <sstream>
#include <string>
#include <vector>

namespace contact_calibration_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinRel;

/// Seven joints that move for a second between two postures, and rest for a second and a half.
faulty_loop_test::Arm resting_arm() {
    faulty_loop_test::Arm arm =
        faulty_loop_test::read_arm("seven_joint_arm/seven_joint_arm.urdf", "seven_joint_loop.json");
    JointVector one(7);
    JointVector other(7);
    one << 0, 0.5, 0, 0.9, 0, 0.4, 0;
    other << 0.6, 0.8, 0.5, 0.5, 0.6, 0.8, 0.6;
    arm.scenario.task = PointToPointTask{{one, other}, 1, 1.5};
    arm.scenario.payloads.clear();
    return arm;
}

/// A model with limits of contacts, of a commissioning run of the nominal loop.
const LoopModel& model_of(const faulty_loop_test::Arm& arm) {
    static const LoopModel model = [&] {
        LoopModel trained = commissioned_model(arm.robot, arm.scenario, structures::P);
        trained.from_prior = false;
        const std::vector recordings{commissioning(arm.robot, arm.scenario)};
        trained.model.contact = measure_contact_limits(trained.model, recordings);
        return trained;
    }();
    return model;
}

/// Runs the arm with the reaction `hold` and passes its loop and summary to `use`.
template <class Use>
void run(const faulty_loop_test::Arm& arm, const LoopModel& model, double calibration_s, double duration_s,
         Use use) {
    LoopLimits limits;
    limits.on_contact = FindingAction::hold;
    limits.contact_calibration_s = calibration_s;
    ClosedLoop loop(arm.robot, arm.scenario, "test", &model, nullptr, limits);
    loop.run_to(duration_s, [](const ClosedLoopInstant&) {});
    std::ostringstream summary;
    print_loop(summary, loop.loop());
    CAPTURE(summary.str());
    use(loop, summary.str());
}

TEST_CASE("a loop that measures its limits first reacts to pushes and not to its own stops", "[contacts]") {
    constexpr double push_s = 75.7;
    faulty_loop_test::Arm arm = resting_arm();
    run(arm, model_of(arm), 0, 10, [](const ClosedLoop& loop, const std::string&) {
        CHECK_FALSE(loop.loop().actions().empty()); // the limits of the commissioning run
    });
    arm.scenario.faults =
        faults_of(R"([{"kind": "push", "joint": 2, "torque_nm": 4, "from_s": 75.7, "for_s": 0.5}])", 7);
    run(arm, model_of(arm), 30, push_s + 1, [&](const ClosedLoop& loop, const std::string& summary) {
        REQUIRE(loop.loop().actions().size() == 1);
        CHECK(loop.loop().actions().front().time_s > push_s);
        CHECK(loop.loop().actions().front().time_s < push_s + 0.1);
        CHECK_THAT(summary, ContainsSubstring("contacts: calibrated, the limits are at most "));
    });
}

TEST_CASE("the summary of a loop gives the motion that its limits of contacts still need", "[contacts]") {
    const faulty_loop_test::Arm arm = resting_arm();
    run(arm, model_of(arm), 30, 10, [](const ClosedLoop& loop, const std::string& summary) {
        CHECK(loop.loop().actions().empty());
        CHECK_THAT(summary, ContainsSubstring("contacts: not calibrated, 2"));
    });
}

TEST_CASE("a model with the limits that a loop has measured reports no contact at its next start",
          "[contacts]") {
    const faulty_loop_test::Arm arm = resting_arm();
    LoopModel calibrated = model_of(arm);
    run(arm, model_of(arm), 30, 80, [&](const ClosedLoop& loop, const std::string&) {
        const auto* const calibration = loop.loop().feed_forward().learned()->contact_calibration();
        REQUIRE(calibration->finished());
        constexpr double per_hour = 3;
        const ContactModel limits =
            contact_at_rate(measured_contact(model_of(arm).model.contact, *calibration, per_hour), per_hour);
        CHECK_THAT(limits.limit[0], WithinRel(double{calibration->limits()[0].limit[0]}, 1e-6));
        CHECK_THAT(limits.relative[6], WithinRel(double{calibration->limits()[6].relative}, 1e-6));
        calibrated.model.contact =
            measured_contact(model_of(arm).model.contact, *calibration, contact_rate_per_hour);
    });
    run(arm, calibrated, 0, 40,
        [](const ClosedLoop& loop, const std::string&) { CHECK(loop.loop().actions().empty()); });
}

} // namespace contact_calibration_test
