// SPDX-License-Identifier: Apache-2.0
// Wrong set-ups of real and simulated recordings are refused with the code of the mistake.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/simulated_runs.hpp"
#include "tests/tools/setup_check/wrong_setups.hpp"

#include <iostream>
#include <string>
#include <vector>

namespace wrong_setups_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

const std::string data = DFDYN_TEST_DATA_DIR;

Setup recorded(const std::string& name, const std::string& file, OutputKind outputs, const Robot& robot) {
    ReadOptions options;
    options.outputs = outputs;
    options.skip_bad_rows = true;
    return {name, outputs, robot, read_recording(data + "/" + file, options)};
}

Setup simulated(std::mt19937_64& engine) {
    RunKind kind;
    kind.friction = 0.3;
    kind.noise = 0.02;
    kind.rate_hz = 125;
    return {"simulated UR5", kind.outputs, ur5(), simulated_run(ur5(), kind, engine)};
}

/// Number of wrong set-ups, and of those that are refused with the right code and with any.
struct Count {
    int all = 0, named = 0, refused = 0;
};

/// Checks that a set-up is accepted, and counts its wrong variants. Prints a row for each.
Count count_refusals(const Setup& right, const Robot& other) {
    CAPTURE(right.name);
    CHECK_FALSE(any_mistake(check_setup(right.recording, {right.outputs, &right.robot})));
    Count count;
    for (const WrongSetup& wrong : wrong_setups(other, right.outputs)) {
        Setup setup = right;
        wrong.make(setup);
        const SetupFindings findings = check_setup(setup.recording, {setup.outputs, &setup.robot});
        const bool named = std::ranges::any_of(findings, [&](const SetupFinding& finding) {
            return finding.severity == Severity::mistake && finding.fault == wrong.fault;
        });
        ++count.all;
        count.named += named ? 1 : 0;
        count.refused += any_mistake(findings) ? 1 : 0;
        std::cout << "| " << right.name << " | " << wrong.name << " | "
                  << (named                   ? name_of(wrong.fault)
                      : any_mistake(findings) ? "another code"
                                              : "accepted")
                  << " |\n";
    }
    return count;
}

TEST_CASE("wrong set-ups of the UR5 and of a simulated arm are refused with their code") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot other = tx40();
    const Count real =
        count_refusals(recorded("UR5 No6", "ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv",
                                OutputKind::motor_current, ur5()),
                       other);
    const Count made = count_refusals(simulated(engine), other);
    CHECK(real.named >= 0.95 * real.all);
    CHECK(made.named >= 0.9 * made.all);
}

TEST_CASE("wrong set-ups of two other laboratories are refused with their code", "[.long]") {
    const Count ur = count_refusals(
        recorded("UR5 of NIST", "ur5_nist/halfspeed_payload_0p726kg.csv", OutputKind::motor_current, ur5()),
        tx40());
    const Count staubli = count_refusals(
        recorded("TX40", "tx40_figaroh/tx40_5kHz.csv", OutputKind::joint_torque, tx40()), ur5());
    CHECK(ur.named >= 0.95 * ur.all);
    CHECK(staubli.named >= 0.95 * staubli.all);
}

} // namespace wrong_setups_test
