// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/setup_check/setup_check.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// A mistake that a user can make with a correct recording.
struct Mistake {
    std::string name;
    tools::SetupFault fault;
    std::function<void(tools::Recording&)> make;
};

/// Common mistakes. Mistakes of one joint affect joint 2 if there are several. `outputs` selects mA or mN·m.
std::vector<Mistake> classic_mistakes(std::size_t joints, tools::OutputKind outputs);

/// The texts of all findings that are mistakes, one per line.
std::string mistakes_of(const tools::SetupFindings& findings);
std::string mistakes_in(const tools::Recording& recording, const tools::SetupQuestion& question);

/// Every `stride`-th row from `first` to `last` (excluded).
tools::Recording cut(const tools::Recording& recording, std::size_t first, std::size_t last,
                     std::size_t stride);

struct Cut {
    std::string name;
    tools::Recording recording;
};

/// Parts of a recording as users cut it: the whole, its halves, 20 s in the middle, every fifth row.
std::vector<Cut> cuts_of(const tools::Recording& recording);

/// Changes the positions or the outputs of every row in place.
void change_positions(tools::Recording& recording, const std::function<void(double*)>& change);
void change_outputs(tools::Recording& recording, const std::function<void(double*)>& change);

/// Multiplies all values by `factor`.
void scale(tools::Columns& columns, double factor);
/// Multiplies the times by `factor`.
void scale_clock(tools::Recording& recording, double factor);

} // namespace dfdyn::tests
