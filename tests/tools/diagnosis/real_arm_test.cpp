// SPDX-License-Identifier: Apache-2.0
// A real UR5 with its motor currents (tests/data/ur5_kufieta/PROVENANCE.md). These facts about it are
// certain:
// - its gears have friction;
// - neither friction nor rotor inertia is negative;
// - the additional mass of its wrist according to the robot's own controller;
// - the times at which somebody pushed it.
#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/finding_parameter.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/support/ur5_runs.hpp"
#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::parameter;

/// Motor currents of the robot; several runs are joined into one recording.
Recording currents(const std::vector<std::string>& runs) {
    return joined_recording(dfdyn::tests::ur5_runs(runs));
}

Diagnosis diagnosis_of_run(const Recording& recording, bool measure = false) {
    DiagnosisOptions how;
    how.outputs = OutputKind::motor_current;
    how.measure = measure;
    return diagnose(dfdyn::tests::ur5(), recording, how).diagnosis;
}

/// Diagnoses one run with torque constants that were estimated from No6 by itself.
Diagnosis diagnosis_with_constants(const std::string& run) {
    DiagnosisOptions how;
    how.outputs = OutputKind::motor_current;
    how.torque_constants = {8.2, 11.4, 9.4, 7.0, 11.0, 1.3};
    return diagnose(dfdyn::tests::ur5(), currents({run}), how).diagnosis;
}

bool is_friction(const Finding& finding) {
    return finding.effect == "viscous_friction" || finding.effect == "coulomb_friction" ||
           finding.effect == "stribeck_friction" || finding.effect == "presliding_hysteresis" ||
           finding.effect == "load_dependent_friction";
}

bool is_contact(const Finding& finding) { return finding.effect == "external_contact"; }

/// Times at which somebody pushed: where the current of joint 2, averaged over a fifth of a second, differs
/// by more than 1 A from the current of the same motion without a push. This uses neither a model nor a
/// diagnosis.
class Pushes {
  public:
    Pushes(const Recording& pushed, const Recording& undisturbed) {
        constexpr std::size_t joint = 1, average = 25;
        const std::size_t rows = std::min(pushed.row_count(), undisturbed.row_count());
        for (std::size_t row = average; row < rows; ++row) {
            double difference = 0;
            for (std::size_t back = 0; back < average; ++back) {
                difference +=
                    pushed.output.row(row - back)[joint] - undisturbed.output.row(row - back)[joint];
            }
            if (std::abs(difference) > 1.0 * average) {
                add(pushed.time_s[row - average / 2]);
            }
        }
    }

    struct Push {
        double start_s, end_s;
    };
    const std::vector<Push>& all() const { return pushes_; }

    static bool during(const Finding& contact, const Push& push) {
        return parameter(contact, "start") < push.end_s && push.start_s < parameter(contact, "end");
    }

  private:
    void add(double time_s) {
        constexpr double apart_s = 0.5;
        if (pushes_.empty() || time_s > pushes_.back().end_s + apart_s) {
            pushes_.push_back({time_s, time_s});
        }
        pushes_.back().end_s = time_s;
    }

    std::vector<Push> pushes_;
};

} // namespace

TEST_CASE("a real arm's joint friction and wrist centre of mass are named and no push is invented") {
    const Diagnosis diagnosis =
        diagnosis_of_run(currents({"No6_Acc_slow_Verify_Model", "No7_Acc_slow_Verify_Model_short"}));
    std::set<std::string> rubbing;
    for (const Finding& finding : diagnosis.findings) {
        INFO(finding.effect << " at " << finding.where);
        CHECK_FALSE(is_contact(finding)); // nobody touched the robot
        if (is_friction(finding)) {
            rubbing.insert(finding.where);
        }
        if (is_friction(finding) || finding.effect == "rotor_inertia") {
            CHECK(finding.parameters.front().value > 0);
        }
    }
    CHECK(rubbing.size() >= 5);
    REQUIRE(diagnosis.nuisance_estimates.size() >= 6);
    for (const NuisanceEstimate& one : diagnosis.nuisance_estimates) {
        INFO(one.where);
        CHECK(one.parameter.low > 0);
    }

    // The robot's file has the wrist's centres of mass on its axes. According to the controller's own
    // rigid-body torques (`taur` of the same recording, with `dfdyn identify`) the first moment of links 4
    // and 5, plus 0.095 m times the mass of link 6, is 0.134 kg·m larger along link 5's axis than in the
    // file. The first moment of links 5 and 6 across that axis is 0.033 kg·m larger.
    const auto wrist = std::ranges::find_if(diagnosis.findings, [](const Finding& finding) {
        return finding.effect == "link_inertia_error" && finding.where == "link5";
    });
    REQUIRE(wrist != diagnosis.findings.end());
    CHECK(wrist->confidence >= 0.5);
    CHECK(parameter(*wrist, "delta_mass") == 0);
    const double mass = dfdyn::tests::ur5().joints[4].inertia[0];
    CHECK(mass * parameter(*wrist, "delta_com_z") == Approx(0.134).epsilon(0.25));
    CHECK(mass * parameter(*wrist, "delta_com_y") == Approx(0.033).epsilon(0.25));
}

TEST_CASE("pushes at a real arm are found at their times and no others") {
    const Recording undisturbed = currents({"No7_Acc_slow_Verify_Model_short"});
    const Recording pushed = currents({"No7_Acc_slow_Verify_Model_short_with_disturbance"});
    const std::vector<Pushes::Push> pushes = Pushes(pushed, undisturbed).all();
    REQUIRE(pushes.size() == 5);
    const Diagnosis diagnosis = diagnosis_of_run(pushed);
    std::set<std::size_t> found, likely;
    for (const Finding& contact : diagnosis.findings) {
        if (!is_contact(contact)) {
            continue;
        }
        const auto push = std::ranges::find_if(
            pushes, [&](const Pushes::Push& one) { return Pushes::during(contact, one); });
        INFO(contact.where << ", " << contact.detail);
        REQUIRE(push != pushes.end());
        const auto number = static_cast<std::size_t>(push - pushes.begin());
        found.insert(number);
        if (contact.confidence >= 0.5) {
            likely.insert(number);
            CHECK((contact.where == "joint2" || contact.where == "joint3"));
        }
    }
    CHECK(likely == std::set<std::size_t>{0, 1, 2}); // at joints at rest
    CHECK(found.size() >= 4);
    for (const char* const run : {"No7_Acc_slow_Verify_Model_short", "No5_Acc_slow_no_disturbance",
                                  "No9_Singularity_Free_NoDist", "No3_Acc"}) {
        INFO(run);
        CHECK(std::ranges::none_of(diagnosis_of_run(currents({run})).findings, is_contact));
    }
}

TEST_CASE(
    "the causes found in one run of a real arm improve the prediction of two other runs at every joint") {
    const Recording all =
        currents({"No6_Acc_slow_Verify_Model", "No5_Acc_slow_no_disturbance", "No9_Singularity_Free_NoDist"});
    const Diagnosis diagnosis = diagnosis_of_run(all, true);
    REQUIRE(diagnosis.heldout_from_s > 85); // the first run ends at 82 s
    for (Eigen::Index joint = 0; joint < 6; ++joint) {
        CAPTURE(joint + 1);
        CHECK(diagnosis.causes.nrmse[joint] < 0.9 * diagnosis.nominal.nrmse[joint]);
        CHECK(diagnosis.causes.moving_nrmse[joint] < 0.65 * diagnosis.nominal.moving_nrmse[joint]);
        CHECK(diagnosis.extended.nrmse[joint] <= 1.03 * diagnosis.least_squares.nrmse[joint]);
    }
    CHECK(std::ranges::none_of(diagnosis.findings, is_contact));
}

TEST_CASE("in a short run of a real arm given torque constants are kept and friction is that of other runs") {
    const Diagnosis diagnosis = diagnosis_with_constants("No1");
    for (const Finding& finding : diagnosis.findings) {
        INFO(finding.effect << " at " << finding.where);
        CHECK_FALSE((finding.effect == "actuator_gain" && finding.confidence >= 0.5));
    }
    // medians of the other runs, printed by tools/measure_repeats.py; with wrong gains they were doubled
    for (const auto& [joint, level] : {std::pair{"joint3", 6.05}, {"joint4", 1.47}}) {
        const auto found = std::ranges::find_if(diagnosis.findings, [joint](const Finding& finding) {
            return finding.effect == "coulomb_friction" && finding.where == joint;
        });
        REQUIRE(found != diagnosis.findings.end());
        CHECK(found->parameters.front().value == Approx(level).epsilon(0.25));
    }
}

TEST_CASE(
    "dry friction of joints 1 and 3 and 5 of a real arm differs by less than 40 % between four recordings",
    "[.long]") {
    std::vector<Diagnosis> diagnoses;
    for (const char* const run : {"No5_Acc_slow_no_disturbance", "No6_Acc_slow_Verify_Model",
                                  "No7_Acc_slow_Verify_Model_short", "No9_Singularity_Free_NoDist"}) {
        diagnoses.push_back(diagnosis_with_constants(run));
    }
    for (const char* const joint : {"joint1", "joint3", "joint5"}) {
        CAPTURE(joint);
        std::vector<double> levels;
        for (const Diagnosis& diagnosis : diagnoses) {
            const auto found = std::ranges::find_if(diagnosis.findings, [joint](const Finding& finding) {
                return finding.effect == "coulomb_friction" && finding.where == joint &&
                       finding.confidence >= 0.5;
            });
            REQUIRE(found != diagnosis.findings.end());
            levels.push_back(found->parameters.front().value);
        }
        const auto [least, most] = std::ranges::minmax(levels);
        CHECK(most < 1.4 * least);
    }
}
