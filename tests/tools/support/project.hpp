// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace dfdyn::tests {

/// The project's folder: for tests that read its sources and documents.
inline const std::filesystem::path project = std::filesystem::path(DFDYN_TEST_DATA_DIR) / "../..";

} // namespace dfdyn::tests
