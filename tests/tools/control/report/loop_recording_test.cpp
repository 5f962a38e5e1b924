// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_recording.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace loop_recording_test {

using namespace dfdyn::tools;

/// Records ticks of 1 ms from 5 s on, whose position is the number of the tick; tick 4 has no torque.
void record(LoopRecording& recording, int ticks) {
    JointVector position(2), torque(2);
    for (int tick = 0; tick < ticks; ++tick) {
        position << tick, 0.5;
        torque << -tick, 2;
        LoopInput input;
        input.time_ns = 5'000'000'000 + std::int64_t{1'000'000} * tick;
        input.position = &position;
        input.torque = tick == 4 ? nullptr : &torque;
        recording.add(input);
    }
}

std::string written(const LoopRecording& recording) {
    std::ostringstream out;
    recording.write(out);
    return out.str();
}

TEST_CASE("a recording keeps one row in every n ticks if position and torque were measured") {
    LoopRecording recording(2, 2, 0.001, 1);
    record(recording, 8);
    CHECK(written(recording) == "t,q1,q2,tau1,tau2\n0,0,0.5,0,2\n0.002,2,0.5,-2,2\n0.006,6,0.5,-6,2\n");
}

TEST_CASE("a tick with a position held from the one before is not recorded") {
    LoopRecording recording(1, 1, 0.001, 1);
    const JointVector value = JointVector::Constant(1, 1);
    const std::vector<bool> missing{true};
    for (int tick = 0; tick < 3; ++tick) {
        LoopInput input;
        input.time_ns = std::int64_t{1'000'000} * tick;
        input.position = input.torque = &value;
        input.missing = tick == 1 ? &missing : nullptr;
        recording.add(input);
    }
    CHECK(written(recording) == "t,q1,tau1\n0,1,1\n0.002,1,1\n");
}

TEST_CASE("a recording ends after its duration and allocates no memory while it runs") {
    LoopRecording recording(2, 1, 0.001, 0.01);
    const dfdyn::tests::AllocationGuard guard;
    record(recording, 100);
    const dfdyn::tests::HeapCalls calls = guard.calls();
    CHECK(calls.allocations == 0);
    const std::string text = written(recording);
    CHECK(std::count(text.begin(), text.end(), '\n') == 12);
}

TEST_CASE("a recording without rows has its header") {
    CHECK(written(LoopRecording(1, 1, 0.001, 1)) == "t,q1,tau1\n");
}

} // namespace loop_recording_test
