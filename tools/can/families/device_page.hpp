// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// Returns the text of docs/reference/devices.md: what the families' descriptors say about their devices.
std::string device_page();

} // namespace dfdyn::tools
