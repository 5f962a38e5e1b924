// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <optional>
#include <string>

namespace dfdyn::tools {

/// From here on a cause is rather there than not.
constexpr double likely_confidence = 0.5;

/// Two decimals, and no certainty: `> 0.99` above that.
std::string confidence_text(double confidence);

/// The axis of an F/T sensor that a parameter stands for; none for a parameter that is a quantity.
std::optional<std::string> axis_of(const FoundParameter& parameter);

/// `coulomb 8.02 N·m (7.95 … 8.09)`, with the 95 % interval; `axis fz` of a sensor's axis.
std::string parameter_words(const FoundParameter& parameter);

/// `7.95 … 8.09`: of 95 %.
std::string interval_words(const FoundParameter& parameter);

/// The first parameter that was measured, or another coordinate of the same vector that is known better, with
/// its interval; empty where there is none.
std::string main_parameter_words(const Finding& finding);

/// `coulomb friction at joint2`; with its detail where there is one.
std::string cause_words(const Finding& finding);
std::string cause_words(const OtherCause& cause);

/// `link2 3.1 (2.9 … 3.3) instead of 3`: without the unit.
std::string granted_words(const GrantedQuantity& granted);

/// The unit of an output by its column's name: `N·m`, `N` or `A`.
std::string output_unit(const std::string& output_name);

} // namespace dfdyn::tools
