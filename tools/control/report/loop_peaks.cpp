// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_peaks.hpp"

#include <iomanip>
#include <sstream>

namespace dfdyn::tools {

namespace {

/// Raises each peak to `value` if that is larger.
void raise(JointVector& peak, const JointVector& value) {
    peak = peak.size() == 0 ? value : JointVector(peak.cwiseMax(value));
}

std::string listed(const JointVector& values, int decimals) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(decimals);
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        text << (i == 0 ? "" : ", ") << values[i];
    }
    return text.str();
}

} // namespace

void LoopPeaks::add(const JointVector& command) {
    if (last_command_.size() > 0) {
        raise(torque_step_, (command - last_command_).cwiseAbs());
    }
    last_command_ = command;
}

void LoopPeaks::add(const JointVector& command, const JointVector& velocity) {
    add(command);
    raise(speed_, velocity.cwiseAbs());
}

void print_peaks(std::ostream& out, const LoopPeaks& peaks) {
    if (peaks.torque_step().size() == 0) {
        return;
    }
    out << "peaks: command, from tick to tick, by " << listed(peaks.torque_step(), 1) << " N·m";
    if (peaks.speed().size() > 0) {
        out << "; joints at " << listed(peaks.speed(), 2) << " rad/s";
    }
    out << '\n';
}

} // namespace dfdyn::tools
