// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// Returns whether a time of a recording (s) counts from 1970: from 10^9 s on, which is in 2001.
bool is_epoch_time(double time_s);

/// Returns a time of a recording with two decimals: `12.50 s`, or `2023-11-14 22:13:20.50 UTC` for a time
/// from 1970.
std::string instant_text(double time_s);

} // namespace dfdyn::tools
