// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <string>

namespace dfdyn::tools {

/// Three significant digits: `0.0123`, `8.02`, `1.2e+04`.
std::string rounded_text(double value);

/// Two decimals, and no certainty: `> 0.99` above that.
std::string confidence_text(double confidence);

/// `coulomb 8.02 N·m (7.95 … 8.09)`, with the 95 % interval; `axis fz` of a sensor's axis.
std::string parameter_words(const FoundParameter& parameter);

/// The first parameter that was measured, with its interval; empty where there is none.
std::string main_parameter_words(const Finding& finding);

/// `coulomb friction at joint2`; with its detail where there is one.
std::string cause_words(const Finding& finding);
std::string cause_words(const OtherCause& cause);

/// The unit of an output by its column's name: `N·m`, `N` or `A`.
std::string output_unit(const std::string& output_name);

} // namespace dfdyn::tools
