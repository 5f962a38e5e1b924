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
    JointVector position, torque; ///< measured
    JointVector error;            ///< reference minus true position, rad
    JointVector command;          ///< N·m
};

/// A loop and the arm of a scenario in one thread, in simulated time: the same inputs give the same bits.
class ClosedLoop {
  public:
    /// `bus`: none, or the devices whose frames go between the two; it must fit the scenario (see
    /// check_bus).
    ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
               const LoopModel* learned, const BusDescription* bus = nullptr);

    /// Runs from where it is to `time_s`, which counts from where the motion began: until then the arm
    /// stands. `on_tick` sees every tick since. Throws InputError as SimulatedPlant does, and when the loop
    /// gets no positions.
    void run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick);

    const ControlLoop& loop() const noexcept { return *loop_; }
    SimulatedPlant& plant() noexcept { return plant_; }

  private:
    /// The wire and its two ends.
    struct Link {
        Link(const BusDescription& bus, double period_s);

        MemoryBus loop_end, plant_end;
        LoopPort loop;
        PlantPort plant;
    };

    LoopInput sense(std::int64_t time_ns, ClosedLoopInstant& instant);
    void command(std::int64_t time_ns, const JointVector& torque);
    void check_waiting() const;

    double period_s_;
    std::unique_ptr<Link> link_; ///< none: readings and torques pass directly
    std::unique_ptr<ControlLoop> loop_;
    SimulatedPlant plant_;
    std::int64_t tick_ = 0, moving_tick_ = 0;
};

/// Throws InputError, naming the description's file, unless it has the robot's joints, its joints' rate is
/// that of the loop, and the scenario has the sensor that it has.
void check_bus(const BusDescription& bus, const Robot& robot, const Scenario& scenario);

} // namespace dfdyn::tools
