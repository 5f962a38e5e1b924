// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/recording/panel_case.hpp"

#include <filesystem>

namespace dfdyn::tests {

/// Writes the recording NAME.csv and the answer NAME.truth.json into `directory`.
void write_panel_case(const PanelCase& panel_case, const std::filesystem::path& directory,
                      const std::string& name);

} // namespace dfdyn::tests
