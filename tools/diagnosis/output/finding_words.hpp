// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <optional>
#include <string>

namespace dfdyn::tools {

/// A cause with at least this confidence is more likely present than absent.
constexpr double likely_confidence = 0.5;

/// Returns a confidence with two decimals, and `> 0.99` above that.
std::string confidence_text(double confidence);

/// Returns the axis of an F/T sensor that a parameter denotes; empty for a parameter that is a quantity.
std::optional<std::string> axis_of(const FoundParameter& parameter);

/// Returns `coulomb 8.02 N·m (7.95 … 8.09)`, with the 95 % interval, or `axis fz` for a sensor axis.
std::string parameter_words(const FoundParameter& parameter);

/// Returns the 95 % interval: `7.95 … 8.09`.
std::string interval_words(const FoundParameter& parameter);

/// Returns the first estimated parameter with its interval, or another component of the same vector with a
/// smaller interval. Empty if no parameter was estimated.
std::string main_parameter_words(const Finding& finding);

/// Returns `coulomb friction at joint2`, with the detail if there is one.
std::string cause_words(const Finding& finding);
std::string cause_words(const OtherCause& cause);

/// Returns the causes that this motion hardly distinguishes from the finding, the closest three and the
/// number of the others: `payload at tool; link inertia error at link5; torque offset at joint3; 2 others`.
std::string tie_words(const Finding& finding);

/// Returns `link2 3.1 (2.9 … 3.3) instead of 3`, without the unit.
std::string nuisance_words(const NuisanceEstimate& nuisance);

} // namespace dfdyn::tools
