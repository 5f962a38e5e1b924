// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/bus/loop_port.hpp"
#include "tools/control/bus/lossy_bus.hpp"
#include "tools/control/bus/memory_bus.hpp"
#include "tools/control/bus/plant_port.hpp"
#include "tools/control/loop_setup.hpp"
#include "tools/control/report/tracking.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <deque>
#include <functional>

namespace dfdyn::tools {

/// One instant of a closed loop, as it was at a tick.
struct ClosedLoopInstant {
    double time_s = 0;   ///< for which it was due
    LoopInput measured;  ///< refers to what lives until the command goes out
    JointVector error;   ///< reference minus true position at that time, rad
    JointVector command; ///< N·m
};

/// A loop and the arm of a scenario in one thread, in simulated time: the same inputs give the same bits.
///
/// The devices measure and send once per period of the loop, whatever the loop does; a tick comes after the
/// cycle that is due with it. A tick that begins late finds what has come meanwhile, and those that have
/// become due follow at once, as in `run_loop`. What goes wrong between the two (LinkFaults) does so from
/// when the loop moves the arm.
class ClosedLoop {
  public:
    /// `bus`: none, or the devices whose frames go between the two; it must fit the scenario (see
    /// check_bus).
    ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
               const LoopModel* learned, const BusDescription* bus = nullptr, const LoopLimits& limits = {});

    /// Runs from where it is to `time_s`, which counts from where the motion began: until then the arm
    /// stands. Ends early when the loop has stopped. `on_tick` sees every tick since, before its command goes
    /// out. Throws InputError as SimulatedPlant does, and when the loop gets no positions.
    void run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick);

    const ControlLoop& loop() const noexcept { return *loop_; }
    /// Uses what is learned, or leaves it out; see FeedForward.
    void enable_learned(bool on) noexcept { loop_->enable_learned(on); }
    SimulatedPlant& plant() noexcept { return plant_; }

  private:
    /// The wire and its two ends.
    struct Link {
        Link(const BusDescription& bus, const Scenario& scenario);

        MemoryBus loop_end, plant_end;
        LossyBus<MemoryBus> devices;
        LoopPort loop;
        PlantPort plant;
    };
    /// What passes directly, where there is no bus.
    struct Readings {
        std::int64_t time_ns = 0;
        bool fresh = false; ///< has not been used yet
        JointVector position, torque;
    };

    /// Of the motion: 0 until it begins.
    double motion_time(std::int64_t tick) const { return static_cast<double>(tick - waited_) * period_s_; }
    /// Of the clock that keeps the pace.
    std::int64_t pace_ns(std::int64_t tick) const;
    const LinkFaults& faults_at(double motion_time_s);
    std::int64_t begin_ns();
    void measure();
    LoopInput sense(std::int64_t due_ns, std::int64_t now_ns);
    void command(std::int64_t now_ns, const JointVector& torque);
    void check_waiting() const;

    double period_s_;
    std::unique_ptr<Link> link_; ///< none: readings and torques pass directly
    std::unique_ptr<ControlLoop> loop_;
    SimulatedPlant plant_;
    FaultSchedule faults_;
    Losses losses_; ///< where there is no bus
    Readings readings_;
    std::int64_t bus_set_ns_ = 0;               ///< what the loop's clock shows beyond that of the pace
    std::int64_t tick_ = 0, waited_ = 0;        ///< all ticks, and those before the motion
    std::int64_t cycle_ = 0;                    ///< of the devices
    std::int64_t begun_ns_ = 0;                 ///< the last tick
    std::deque<JointVector> position_when_due_; ///< true, rad; of the ticks from this one on
};

} // namespace dfdyn::tools
