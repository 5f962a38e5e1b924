// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_page.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/small_fitted_effects.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/output/diagnosis_summary.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"

#include <memory>
#include <sstream>

namespace diagnosis_page_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using Eigen::VectorXd;

ErrorMeasure error_of(double rms) {
    return {VectorXd::Constant(6, rms), VectorXd::Constant(6, 0.1), VectorXd::Constant(6, 0.1)};
}

/// The work of a diagnosis with fitted effects, without findings, whose error changes from 1 N·m to
/// `extended_rms`.
DiagnosisWork work_with_error(double extended_rms) {
    DiagnosisWork work;
    auto signals = std::make_shared<DiagnosisSignals>(signals_of(ur5(), OutputKind::joint_torque));
    work.signals = signals;
    work.measured = work.extended = signals->nominal;
    work.rest = Eigen::MatrixXd::Zero(signals->rows(), signals->outputs());
    work.torque_gains = VectorXd::Ones(signals->outputs());
    work.fitted_effects = fitted_effects_of(
        {of_one_column("coulomb_friction", "joint1", signals->direction(0))}, 0, work.rest.col(0));
    work.fitted_effects.noise = {};
    Diagnosis& diagnosis = work.diagnosis;
    diagnosis.output_names = output_names(OutputKind::joint_torque, 6);
    set_output_units(diagnosis, ur5(), OutputKind::joint_torque);
    diagnosis.nominal = error_of(1);
    diagnosis.extended = diagnosis.causes = diagnosis.least_squares = error_of(extended_rms);
    diagnosis.standstill_share = VectorXd::Zero(6);
    diagnosis.heldout_to_s = 10;
    return work;
}

std::string page_of(const DiagnosisWork& work, const OnlineView& online = {}) {
    const Robot robot = ur5();
    const std::vector<Recording> recordings(1);
    const ModelExtension extension;
    return diagnosis_page({robot, recordings, work, extension, online});
}

TEST_CASE("the page of a diagnosis states whether the error falls or rises, with its unit") {
    CHECK_THAT(page_of(work_with_error(0.5)), ContainsSubstring("it falls from 1 to 0.5 N·m rms"));
    CHECK_THAT(page_of(work_with_error(2)), ContainsSubstring("it rises from 1 to 2 N·m rms"));
}

TEST_CASE("the page of a diagnosis has the online learners only if they were run") {
    OnlineView online;
    online.learners.push_back({"P", VectorXd::Ones(6), VectorXd::Ones(6)});
    CHECK_THAT(page_of(work_with_error(1), online), ContainsSubstring("As an online learner sees it"));
    CHECK_THAT(page_of(work_with_error(1)), !ContainsSubstring("As an online learner sees it"));
}

TEST_CASE("page and summary of a diagnosis name the rows that were diagnosed") {
    DiagnosisWork work = work_with_error(1);
    work.diagnosis.heldout_to_s = 0;
    CHECK_THAT(page_of(work), ContainsSubstring("Over the whole recording, which the extended model"));
    work.diagnosis.scope = "the first 315 of 450 rows";
    CHECK_THAT(page_of(work), ContainsSubstring("Over the first 315 of 450 rows, which the extended model") &&
                                  !ContainsSubstring("the whole recording"));
    std::ostringstream summary;
    print_diagnosis(summary, work.diagnosis, {});
    CHECK_THAT(summary.str(), ContainsSubstring("over the first 315 of 450 rows:"));
}

TEST_CASE("a push at a joint at rest has the unit of the joint") {
    Robot robot = ur5();
    robot.joints[2].prismatic = true;
    const DiagnosisSignals signals = signals_of(robot, OutputKind::joint_torque);
    const DiagnosisWork work = work_with_error(1);
    for (const std::size_t joint : {1U, 2U}) {
        StationaryContact push;
        push.joint = joint;
        push.pulse = {8, 9, 0.2};
        push.change = 30;
        push.held = 10;
        push.noise = 0.5;
        push.change_deviation = push.held_deviation = 1;
        push.share = 30 * pulse_series(signals, push.pulse);
        Eigen::MatrixXd rest = work.rest;
        const std::vector<Finding> findings =
            findings_of(signals, work.fitted_effects, {push}, rest, work.diagnosis.output_names);
        REQUIRE(findings.size() == 1);
        const std::string& evidence = findings.front().evidence;
        CAPTURE(joint, evidence);
        CHECK_THAT(evidence,
                   ContainsSubstring(joint == 2
                                         ? "by 10 ± 1.96 N, noise by 0.5, but its force changes by 30"
                                         : "by 10 ± 1.96 N·m, noise by 0.5, but its torque changes by 30"));
    }
}

} // namespace diagnosis_page_test
