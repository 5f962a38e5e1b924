// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// One line that belongs to every printed time or size: version, compiler, the exact code generation flags of
/// this build and the vector instructions that Eigen uses in it.
std::string build_flags();

} // namespace dfdyn::tools
