// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tools/base/recording/recording.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;

Recording read_ur5(const std::string& name) {
    return read_recording(std::filesystem::path(DFDYN_TEST_DATA_DIR) / "ur5_kufieta" / name,
                          {.joint_count = 6, .outputs = OutputKind::motor_current, .velocity = true});
}

Recording read_six_joints(const std::string& name, OutputKind outputs) {
    return read_recording(std::filesystem::path(DFDYN_TEST_DATA_DIR) / name,
                          {.joint_count = 6, .outputs = outputs});
}

std::int64_t longest_step_ns(const Recording& recording) {
    std::int64_t longest = 0;
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        longest = std::max(longest, recording.time_ns[row] - recording.time_ns[row - 1]);
    }
    return longest;
}

} // namespace

TEST_CASE("the shipped recordings of the UR5 are read completely") {
    const auto [name, rows, end_ns,
                longest_ns] = GENERATE(table<std::string, std::size_t, std::int64_t, std::int64_t>({
        {"Movement_No3_Acc.csv", 1251, 19'855'437'000, 24'367'000},
        {"Movement_No5_Acc_slow_no_disturbance.csv", 3255, 26'032'000'000, 8'000'000},
        {"Movement_No6_Acc_slow_Verify_Model.csv", 10264, 82'104'000'000, 8'000'000},
        {"Movement_No7_Acc_slow_Verify_Model_short.csv", 3470, 27'752'000'000, 8'000'000},
        {"Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv", 3420, 27'352'000'000, 8'000'000},
        {"Movement_No9_Singularity_Free_NoDist.csv", 2727, 21'808'000'000, 8'000'000},
    }));
    CAPTURE(name);
    const Recording recording = read_ur5(name);
    CHECK(recording.row_count() == rows);
    CHECK(recording.time_ns.back() == end_ns);
    CHECK(longest_step_ns(recording) == longest_ns);
    CHECK(std::count(recording.gap_before.begin(), recording.gap_before.end(), 1) == 1);
    CHECK(recording.ignored_columns == joint_names("taur", 6));
}

TEST_CASE("values of a shipped recording are in their columns") {
    const Recording recording = read_ur5("Movement_No6_Acc_slow_Verify_Model.csv");
    CHECK(recording.position.row(0)[0] == -1.570796);
    CHECK(recording.position.row(0)[5] == -0.000299);
    CHECK(recording.velocity.row(0)[0] == 0);
    CHECK(recording.output.row(1)[0] == 0.006725);
    CHECK(recording.output.row(1)[5] == 0.091502);
}

TEST_CASE("the shipped recordings of the TX40 and of the second UR5 are read completely") {
    const Recording tx40 = read_six_joints("tx40_figaroh/tx40_5kHz.csv", OutputKind::joint_torque);
    CHECK(tx40.row_count() == 37'500);
    CHECK(tx40.time_ns.back() == 7'499'800'000);
    CHECK(longest_step_ns(tx40) == 200'000);
    CHECK(tx40.output.row(0)[1] == -24.3315);
    const Recording ur5 =
        read_six_joints("ur5_nist/halfspeed_payload_0p726kg.csv", OutputKind::motor_current);
    CHECK(ur5.row_count() == 7906);
    CHECK(ur5.time_ns.back() == 63'240'000'000);
    CHECK(longest_step_ns(ur5) == 8'000'000);
    CHECK(ur5.output.row(0)[1] == -2.398737);
}
