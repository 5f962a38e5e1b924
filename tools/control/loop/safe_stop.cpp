// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/safe_stop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

const char* name(LoopState state) noexcept {
    switch (state) {
    case LoopState::waiting:
        return "waiting";
    case LoopState::running:
        return "running";
    case LoopState::stopping:
        return "stopping";
    case LoopState::stopped:
        return "stopped";
    }
    return "unknown";
}

const char* name(StopCause cause) noexcept {
    switch (cause) {
    case StopCause::none:
        return "none";
    case StopCause::requested:
        return "requested";
    case StopCause::no_position:
        return "no_position";
    case StopCause::missed_deadlines:
        return "missed_deadlines";
    case StopCause::following_error:
        return "following_error";
    case StopCause::bus_lost:
        return "bus_lost";
    case StopCause::overspeed:
        return "overspeed";
    case StopCause::torque_limit:
        return "torque_limit";
    case StopCause::frozen_encoder:
        return "frozen_encoder";
    case StopCause::finding:
        return "finding";
    }
    return "unknown";
}

SafeStop::SafeStop(SafeStopConfig config) : config_(std::move(config)) {}

void SafeStop::count(const TickHealth& health) {
    if (health.returning) {
        returning_ = counted(returning_, config_.return_patience);
    } else {
        lost_ = counted(lost_, config_.position_patience);
    }
    lost_ = std::min(lost_, health.longest_silence);
    returning_ = std::min(returning_, health.longest_silence);
    if (health.position_valid) {
        lost_ = returning_ = 0;
    }
    missed_ = health.deadline_missed ? counted(missed_, config_.deadline_patience) : 0;
}

StopCause SafeStop::judge(const TickHealth& health, const JointVector& error) {
    if (health.stop_requested) {
        return StopCause::requested;
    }
    if (health.bus_lost) {
        return StopCause::bus_lost;
    }
    if (lost_ > config_.position_patience || returning_ > config_.return_patience) {
        joint_ = health.silent_joint;
        return StopCause::no_position;
    }
    if (missed_ > config_.deadline_patience) {
        return StopCause::missed_deadlines;
    }
    if (health.joint != StopCause::none) {
        joint_ = health.joint == StopCause::finding ? std::nullopt : std::optional(health.joint_number);
        return health.joint;
    }
    for (Eigen::Index joint = 0; joint < error.size(); ++joint) {
        if (!(std::abs(error[joint]) <= config_.following_error[joint])) { // NaN does not follow
            joint_ = joint;
            return StopCause::following_error;
        }
    }
    return StopCause::none;
}

LoopState SafeStop::tick(const TickHealth& health, const JointVector& error) {
    count(health);
    if (state_ == LoopState::waiting && !health.position_valid && !health.stop_requested) {
        return state_; // waits for a bus that is not up yet
    }
    if (state_ == LoopState::stopping) {
        state_ = ++ramped_ < config_.ramp_ticks ? state_ : LoopState::stopped;
    }
    if (state_ < LoopState::stopping) {
        cause_ = judge(health, error);
        if (cause_ == StopCause::none) {
            state_ = LoopState::running;
        } else {
            // a loop that has not moved the arm has no torque to ramp down
            state_ = state_ == LoopState::waiting ? LoopState::stopped : LoopState::stopping;
        }
    }
    return state_;
}

} // namespace dfdyn::tools
