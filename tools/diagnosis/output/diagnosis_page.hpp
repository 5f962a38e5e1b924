// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"
#include "tools/diagnosis/extension/online_view.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// All that the report of a diagnosis tells of. `extension` and `online` are empty where the recording could
/// not answer.
struct DiagnosisCase {
    const Robot& robot;
    const std::vector<Recording>& recordings;
    const DiagnosisWork& work;
    const Extension& extension;
    const OnlineView& online;
};

/// The report as one HTML page that needs no other file, no network and no script.
std::string diagnosis_page(const DiagnosisCase& one);

} // namespace dfdyn::tools
