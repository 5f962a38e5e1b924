// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <span>

namespace dfdyn::tools {

/// Several recordings as one with gaps: each begins two seconds after the last row of the one before it. At
/// least one; all of the same columns.
Recording joined_recording(std::span<const Recording> recordings);

} // namespace dfdyn::tools
