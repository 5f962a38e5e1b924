// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/choose_forgetting.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/evaluation/small_experiment.hpp"
#include "tools/evaluation/train_case.hpp"

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// What a case chooses that may learn for ever or forget within a hundred samples, where the first output's
/// sign turns at `turn_at`.
double chosen(std::size_t turn_at) {
    const TemporaryDirectory directory;
    const std::filesystem::path log = directory.write("run.csv", small_recording(2000, 2));
    ReadOptions options;
    options.outputs = OutputKind::tau;
    options.rows = {0, 150};
    const Recording start = read_recording(log, options);
    options.rows = {150, 2000};
    Recording online = read_recording(log, options);
    for (std::size_t row = turn_at; row < online.row_count(); ++row) {
        online.output.values[2 * row] *= -1;
    }
    Case one;
    one.lags = 4;
    one.feature_count = 20;
    one.likelihood_rows = 40;
    one.starts = 1;
    one.forgetting_factors = {1, 0.99};
    CaseMemory memory;
    const RobotChoice no_robot;
    return train_case(one, {no_robot, OutputKind::tau, start, online, 1}, 3, memory, [](double) {})
        .forgetting_factor;
}

} // namespace

TEST_CASE("of several forgetting factors the one is chosen that predicts the rest of the training log best") {
    CHECK(chosen(1850) == 1);   // nothing changes
    CHECK(chosen(400) == 0.99); // all that was learned before is wrong
}
