// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// A mistake that somebody can make with a right recording.
struct Mistake {
    std::string name;
    tools::SetupFault fault;
    std::function<void(tools::Recording&)> make;
};

/// The classic ones. Of one joint: joint 2, where there are several. `outputs` decides about mA and mN·m.
std::vector<Mistake> classic_mistakes(std::size_t joints, tools::OutputKind outputs);

/// Every `stride`-th of the rows from `first` to `last` (not included).
tools::Recording cut(const tools::Recording& recording, std::size_t first, std::size_t last,
                     std::size_t stride);

struct Cut {
    std::string name;
    tools::Recording recording;
};

/// A recording as users cut it: whole, its halves, 20 s in the middle, every fifth row.
std::vector<Cut> cuts_of(const tools::Recording& recording);

/// Changes every row's positions (outputs) in place.
void change_positions(tools::Recording& recording, const std::function<void(double*)>& change);
void change_outputs(tools::Recording& recording, const std::function<void(double*)>& change);

/// Multiplies the times.
void scale_clock(tools::Recording& recording, double factor);

} // namespace dfdyn::tests
