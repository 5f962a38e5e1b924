// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/effects/effect.hpp"

#include <array>
#include <vector>

namespace dfdyn::tests {

/// A mistake in the columns of an effect.
enum class ColumnFault : std::uint8_t { sign, absolute_value, other_output, zero };

inline constexpr std::array column_faults{ColumnFault::sign, ColumnFault::absolute_value,
                                          ColumnFault::other_output, ColumnFault::zero};

const char* name_of(ColumnFault fault);

/// Returns the catalogue with `fault` in every column of the effect `name`, in candidates of all kinds. One
/// such catalogue can be in use at a time. `other_output` moves each column to the next of `outputs`.
std::vector<tools::Effect> catalogue_with_fault(const std::string& name, ColumnFault fault,
                                                Eigen::Index outputs);

/// Returns whether the faults changed any column since the catalogue was made. If not, the broken effect
/// equals the right one: the absolute value of a column without negative values.
bool fault_changed_columns();

} // namespace dfdyn::tests
