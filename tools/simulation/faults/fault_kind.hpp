// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/faults/fault.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// One entry of a scenario's `faults`: ScenarioReader's fields, and fields that several kinds share. Every
/// method throws InputError as JsonReader does.
class FaultReader : public ScenarioReader {
  public:
    /// `loop_period_s`: period of the loop's ticks and of the devices' cycles.
    FaultReader(const ScenarioReader& entry, double loop_period_s)
        : ScenarioReader(entry), loop_period_s_(loop_period_s) {}

    double loop_period_s() const noexcept { return loop_period_s_; }

    /// Reads `from_s` (default 0) and `for_s` (default: to the end), the period of activity.
    Fault lasting() const;
    /// Reads `at_s`, the beginning, and `for_s` (default: to the end).
    Fault since() const;
    Fault since(double for_s) const;

    /// Reads `joint`: a number or a list of numbers from 1, returned as indices from 0. Default: all joints.
    std::vector<Eigen::Index> joints() const;
    /// Reads `joint`, which is required.
    std::vector<Eigen::Index> named_joints() const;

  private:
    double loop_period_s_;
};

/// A kind of fault: its name and fields in a scenario, and the function that makes a fault from them.
struct FaultKind {
    std::string_view name;
    std::vector<std::string_view> fields; ///< in addition to `kind`
    Fault (*read)(const FaultReader& reader);
};

/// In the order of the documentation. To add a kind, write one file, declare it here, and add a line to the
/// catalogue.
namespace fault_kinds {

FaultKind friction_step();
FaultKind push();
FaultKind actuator_gain();
FaultKind actuator_saturation();
FaultKind encoder_frozen();
FaultKind encoder_jump();
FaultKind torque_bias();
FaultKind torque_scale();
FaultKind frames_lost();
FaultKind cycles_lost();
FaultKind late_ticks();
FaultKind clock_jump();

} // namespace fault_kinds

/// Returns all kinds.
const std::vector<FaultKind>& fault_catalogue();

/// Returns the names of all kinds, separated by commas, with `conjunction` before the last one.
std::string fault_kind_names(const std::string& conjunction);

} // namespace dfdyn::tools
