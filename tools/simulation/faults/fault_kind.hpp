// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/faults/fault.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// One entry of a scenario's `faults`: ScenarioReader's fields, and those that several kinds have. Every
/// method throws InputError as JsonReader does.
class FaultReader : public ScenarioReader {
  public:
    /// `loop_period_s`: of the loop's ticks, and of the devices' cycles.
    FaultReader(const ScenarioReader& entry, double loop_period_s)
        : ScenarioReader(entry), loop_period_s_(loop_period_s) {}

    double loop_period_s() const noexcept { return loop_period_s_; }

    /// `from_s` (0) and `for_s` (to the end): when the fault acts.
    Fault lasting() const;
    /// `at_s`: when it begins; it acts for `for_s`, or to the end.
    Fault since() const;
    Fault since(double for_s) const;

    /// `joint`: a number or a list of numbers from 1, as indices from 0; left out: all joints.
    std::vector<Eigen::Index> joints() const;
    /// The same, but not left out.
    std::vector<Eigen::Index> named_joints() const;

  private:
    double loop_period_s_;
};

/// A kind of fault: its name in a scenario, the fields that it has, and how they become a fault.
struct FaultKind {
    std::string_view name;
    std::vector<std::string_view> fields; ///< beside `kind`
    Fault (*read)(const FaultReader& reader);
};

/// In the order of the documentation. A new kind is one file, with one line here and in the catalogue.
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

/// All kinds.
const std::vector<FaultKind>& fault_catalogue();

/// Their names, separated by commas; before the last one `conjunction`.
std::string fault_kind_names(const std::string& conjunction);

} // namespace dfdyn::tools
