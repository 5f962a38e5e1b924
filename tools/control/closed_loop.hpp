// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop_port.hpp"
#include "tools/control/loop_setup.hpp"
#include "tools/control/memory_bus.hpp"
#include "tools/control/plant_port.hpp"
#include "tools/control/tracking.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <functional>

namespace dfdyn::tools {

/// One instant of a closed loop, as it was at a tick.
struct ClosedLoopInstant {
    double time_s = 0;
    LoopInput measured;  ///< refers to what lives until the command goes out
    JointVector error;   ///< reference minus true position, rad
    JointVector command; ///< N·m
};

/// A loop and the arm of a scenario in one thread, in simulated time: the same inputs give the same bits.
class ClosedLoop {
  public:
    /// `bus`: none, or the devices whose frames go between the two; it must fit the scenario (see
    /// check_bus).
    ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
               const LoopModel* learned, const BusDescription* bus = nullptr);

    /// Runs from where it is to `time_s`, which counts from where the motion began: until then the arm
    /// stands. Ends early when the loop has stopped. `on_tick` sees every tick since, before its command goes
    /// out. Throws InputError as SimulatedPlant does, and when the loop gets no positions.
    void run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick);

    const ControlLoop& loop() const noexcept { return *loop_; }
    SimulatedPlant& plant() noexcept { return plant_; }

  private:
    /// The wire and its two ends.
    struct Link {
        Link(const BusDescription& bus, const Scenario& scenario);

        MemoryBus loop_end, plant_end;
        LoopPort loop;
        PlantPort plant;
    };

    LoopInput sense(std::int64_t time_ns);
    void command(std::int64_t time_ns, const JointVector& torque);
    void check_waiting() const;

    double period_s_;
    std::unique_ptr<Link> link_; ///< none: readings and torques pass directly
    std::unique_ptr<ControlLoop> loop_;
    SimulatedPlant plant_;
    JointVector position_, torque_; ///< as read directly
    std::int64_t tick_ = 0, moving_tick_ = 0;
};

} // namespace dfdyn::tools
