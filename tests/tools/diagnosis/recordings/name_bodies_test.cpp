// SPDX-License-Identifier: Apache-2.0
// What is said about loads of single recordings.
#include "tools/diagnosis/recordings/name_bodies.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/candidates/point_mass.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace name_bodies_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;

const std::vector<double> ends_s{9.9, 19.9};

/// A diagnosis of two joined recordings of 10 s.
DiagnosisWork work_of_two() {
    DiagnosisWork work;
    work.signals = std::make_shared<DiagnosisSignals>(signals_of(ur5(), OutputKind::joint_torque));
    work.diagnosis.output_names = {"tau1", "tau2", "tau3", "tau4", "tau5", "tau6"};
    return work;
}

SeveralRecordings several_of_two(bool loads_differ) {
    SeveralRecordings several;
    several.names = {"a.csv", "b.csv"};
    several.pooled = {0, 1};
    several.loads_differ = loads_differ;
    return several;
}

void name(DiagnosisWork& work, const SeveralRecordings& several) {
    const DiagnosisSignals& signals = *work.signals;
    const ErrorReduction reduction(signals, Eigen::MatrixXd::Zero(signals.rows(), signals.outputs()),
                                   work.diagnosis.output_names);
    name_bodies(work, several, ends_s, reduction, false);
}

/// A load whose centre was determined in a plane, picked up where the second recording begins.
Finding taken_at_border() {
    Finding taken;
    taken.effect = "payload";
    taken.where = "tool";
    taken.confidence = 0.9;
    taken.parameters = {{"mass", "kg", 0.1, 0.09, 0.11},
                        {"com_x", "m", 0, 0, 0},
                        {"com_y", "m", 0, 0, 0},
                        {"attached", "s", 10.5, 10.4, 10.6}};
    return taken;
}

TEST_CASE(
    "a load at a recording's beginning is doubted, and --changed payload is named unless it was given") {
    const std::string remedy = "--changed payload seeks such loads";
    for (const bool loads_differ : {false, true}) {
        DiagnosisWork work = work_of_two();
        work.diagnosis.findings = {taken_at_border()};
        name(work, several_of_two(loads_differ));
        const Finding& taken = work.diagnosis.findings.front();
        CHECK(taken.confidence < 0.5);
        CHECK_THAT(taken.evidence, ContainsSubstring("it begins where a recording does"));
        CHECK((taken.evidence.find(remedy) == std::string::npos) == loads_differ);
    }
}

TEST_CASE("the remark on a subtracted load has three digits of its mass") {
    DiagnosisWork work = work_of_two();
    SeveralRecordings several = several_of_two(true);
    RecordingLoad load;
    load.recording = std::size_t{1};
    load.margin = 10;
    load.parameters = point_mass(0.10654321, {0.01, 0.02, 0.03});
    load.covariance = 1e-6 * Eigen::Matrix<double, 10, 10>::Identity();
    load.of_body = load.parameters;
    several.answer.loads = {std::move(load)};
    name(work, several);
    REQUIRE(work.diagnosis.suspicions.size() == 1);
    CHECK_THAT(work.diagnosis.suspicions.front().text, ContainsSubstring("a load of 0.107 kg, fitted"));
    REQUIRE(work.diagnosis.findings.size() == 1);
    CHECK(work.diagnosis.findings.front().only_in == "b.csv");
    DiagnosisWork second = work_of_two();
    second.diagnosis.findings = {taken_at_border()};
    name(second, several);
    CHECK_THAT(second.diagnosis.findings.front().evidence,
               ContainsSubstring("besides the load that is subtracted from this recording"));
}

} // namespace name_bodies_test
