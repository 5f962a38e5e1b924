// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"
#include "tools/diagnosis/extension/online_view.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Content of a diagnosis report. `extension` and `online` are empty if the recording is unsuitable.
struct DiagnosisCase {
    const Robot& robot;
    const std::vector<Recording>& recordings;
    const DiagnosisWork& work;
    const ModelExtension& extension;
    const OnlineView& online;
    std::string full_data{}; ///< name of the table of all rows beside the page; empty: none
};

/// Returns the report as one HTML page without external files, network access or scripts.
std::string diagnosis_page(const DiagnosisCase& one);

} // namespace dfdyn::tools
