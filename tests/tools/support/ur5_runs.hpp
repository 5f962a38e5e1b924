// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// Motor currents of a real UR5 (tests/data/ur5_kufieta/PROVENANCE.md). `runs`: names as `No3_Acc`.
inline std::vector<tools::Recording> ur5_runs(const std::vector<std::string>& runs) {
    std::vector<std::filesystem::path> files;
    for (const std::string& run : runs) {
        files.push_back(std::filesystem::path(DFDYN_TEST_DATA_DIR "/ur5_kufieta") /
                        ("Movement_" + run + ".csv"));
    }
    tools::ReadOptions columns;
    columns.joint_count = 6;
    columns.outputs = tools::OutputKind::motor_current;
    columns.skip_bad_rows = true;
    return tools::read_recordings(files, columns);
}

} // namespace dfdyn::tests
