// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// Returns the text of docs/reference/devices.md from the families' descriptors.
std::string device_page();

} // namespace dfdyn::tools
