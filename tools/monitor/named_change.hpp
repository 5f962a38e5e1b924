// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

struct MonitorSetup;

/// One parameter of a change, with its unit.
struct ChangeParameter {
    std::string name, unit;
    double value = 0;
};

/// A change with the names and units of the arm.
struct NamedChange {
    std::int64_t onset_ns = 0, alarm_ns = 0; ///< on the samples' clock
    std::int64_t end_ns = 0;                 ///< when it was learned or had passed; 0: not by the end
    Cause cause = Cause::unknown, runner_up = Cause::unknown;
    double confidence = 0, runner_up_confidence = 0; ///< 0 … 1
    std::string where;                               ///< tool, jointK, encoderK, ft_sensor or an output
    std::string shown_by; ///< the output whose innovations raised the alarm, `all`, or `repeats`
    std::vector<ChangeParameter> parameters;
};

/// The changes of one recording. Its own times are those of the samples' clock plus `origin_s`.
struct RecordedChanges {
    std::string recording;
    double origin_s = 0;
    std::vector<NamedChange> changes;
};

/// Returns a change with the names and units of the arm.
NamedChange named(const Change<float, dynamic>& change, const MonitorSetup& setup);
NamedChange named(const Change<float, 6>& change, const MonitorSetup& setup);

/// Prints a line for each change.
void print_changes(std::ostream& out, const RecordedChanges& recorded);

/// Returns the content of changes.json (schema dfdyn.changes/1, docs/guide/monitor.md). `false_alarm_hours`:
/// mean time between false alarms that the threshold is for.
nlohmann::ordered_json changes_json(std::span<const RecordedChanges> recordings, double false_alarm_hours);

} // namespace dfdyn::tools
