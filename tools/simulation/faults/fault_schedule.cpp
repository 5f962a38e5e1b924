// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

FaultSchedule::FaultSchedule(std::vector<Fault> faults, std::size_t joints)
    : faults_(std::move(faults)), now_(static_cast<Eigen::Index>(joints)), acting_(faults_.size()) {}

bool FaultSchedule::go_to(double time_s) {
    const std::int64_t time_ns = std::llround(time_s * 1e9);
    if (valid_from_ns_ <= time_ns && time_ns < valid_until_ns_) {
        return false;
    }
    find_next_change(time_ns);
    bool changed = false;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        changed = changed || acting_[i] != acts(faults_[i], time_ns);
        acting_[i] = acts(faults_[i], time_ns);
    }
    if (changed) {
        now_ = Faults(now_.arm.load.size());
        for (std::size_t i = 0; i < faults_.size(); ++i) {
            if (acting_[i]) {
                faults_[i].act(now_);
            }
        }
    }
    return changed;
}

void FaultSchedule::find_next_change(std::int64_t time_ns) {
    valid_from_ns_ = std::numeric_limits<std::int64_t>::min();
    valid_until_ns_ = std::numeric_limits<std::int64_t>::max();
    for (const Fault& fault : faults_) {
        for (const std::int64_t change_ns : {fault.from_ns, fault.until_ns}) {
            if (change_ns <= time_ns) {
                valid_from_ns_ = std::max(valid_from_ns_, change_ns);
            } else {
                valid_until_ns_ = std::min(valid_until_ns_, change_ns);
            }
        }
    }
}

} // namespace dfdyn::tools
