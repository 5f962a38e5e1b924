// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/plan/plan_data.hpp"

#include "tools/base/recording/row_parts.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/experiment/plan/file_checksum.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

namespace fs = std::filesystem;

Recording read_rows(const fs::path& log, const Plan& plan, std::size_t joints, RowRange rows) {
    ReadOptions options;
    options.velocity = options.acceleration = true;
    options.joint_count = joints;
    options.outputs = plan.outputs;
    options.rows = rows;
    return read_recording(log, options);
}

void read_subsets(const Plan& plan, std::size_t joints, PlanData& data) {
    for (const TestLog& test : plan.tests) {
        for (std::size_t subset = 0; subset < test.count; ++subset) {
            const std::size_t first = test.first + subset * test.rows;
            data.subsets.push_back(read_rows(test.log, plan, joints, {first, first + test.rows}));
        }
    }
}

/// Refuses recordings with another sample period than the start's: every model would take faster rows for its
/// own samples, and slower ones for gaps.
void check_periods(const Plan& plan, const PlanData& data) {
    const double period_s = sample_period_s({&data.start, 1});
    const std::string model = "plan " + in_quotes(plan.name);
    check_period(data.online, period_s, model);
    for (const Recording& subset : data.subsets) {
        check_period(subset, period_s, model);
    }
}

double variance_of(const std::vector<Recording>& recordings, std::size_t output) {
    double count = 0;
    double mean = 0;
    double squares = 0;
    for (const Recording& recording : recordings) {
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            const double difference = recording.output.row(row)[output] - mean;
            count += 1;
            mean += difference / count;
            squares += difference * (recording.output.row(row)[output] - mean);
        }
    }
    return squares / count;
}

std::vector<std::size_t> numbers_of(const OutputGroup& group, const std::vector<std::string>& names) {
    std::vector<std::size_t> numbers;
    for (const std::string& output : group.outputs) {
        const auto found = std::ranges::find(names, output);
        if (found == names.end()) {
            throw InputError("plan: group " + in_quotes(group.name) + ": expected outputs among " +
                             listed(names) + ", found " + in_quotes(output));
        }
        numbers.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    return numbers;
}

} // namespace

PlanData load_plan_data(const Plan& plan) {
    PlanData data;
    data.start = read_rows(plan.training_log, plan, 0, {0, plan.start_rows});
    const std::size_t joints = data.start.joint_count();
    data.online = read_rows(plan.training_log, plan, joints, {plan.start_rows, plan.training_rows});
    if (plan.most_online_rows && *plan.most_online_rows < data.online.row_count()) {
        data.online = rows_between(std::move(data.online), 0, *plan.most_online_rows);
    }
    read_subsets(plan, joints, data);
    check_periods(plan, data);
    const std::vector<std::string>& names = data.start.output.names;
    for (std::size_t output = 0; output < names.size(); ++output) {
        data.output_variance.push_back(variance_of(data.subsets, output));
    }
    for (const OutputGroup& group : plan.groups) {
        data.group_outputs.push_back(numbers_of(group, names));
    }
    data.checksums.emplace_back(plan.training_log.filename(), file_checksum(plan.training_log));
    for (const TestLog& test : plan.tests) {
        data.checksums.emplace_back(test.log.filename(), file_checksum(test.log));
    }
    if (fs::exists(plan.robot.urdf)) { // a missing file is an error of the cases that need it
        data.checksums.emplace_back(plan.robot.urdf.filename(), file_checksum(plan.robot.urdf));
    }
    return data;
}

} // namespace dfdyn::tools
