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

/// State of a closed loop at one tick.
struct ClosedLoopInstant {
    double time_s = 0;   ///< due time
    LoopInput measured;  ///< valid until the command is sent
    JointVector error;   ///< reference minus true position at this time, rad
    JointVector command; ///< N·m
};

/// Time from a simulated push to the loop's reaction to the contact.
struct PushReaction {
    double push_s = 0;  ///< begin of the push, since the beginning of the motion
    double after_s = 0; ///< from there to the first command of the reaction
};

/// A loop and the arm of a scenario in one thread, in simulated time. Equal inputs give bit-identical
/// results.
///
/// The devices measure and send once per period of the loop, independently of the loop. A tick follows the
/// cycle that is due at the same time. A late tick receives everything that has arrived meanwhile, and
/// overdue ticks follow immediately, as in `run_loop`. Faults of the link (LinkFaults) begin when the loop
/// moves the arm.
class ClosedLoop {
  public:
    /// `bus`: the devices whose frames connect the two; null for a direct connection. It must match the
    /// scenario (see check_bus).
    ClosedLoop(const Robot& robot, const Scenario& scenario, const std::string& source,
               const LoopModel* learned, const BusDescription* bus = nullptr, const LoopLimits& limits = {});

    /// Runs to `time_s`, counted from the beginning of the motion; the arm is at rest before it. Ends early
    /// if the loop has stopped. `on_tick` is called at every tick of the motion, before its command is sent.
    /// Throws InputError as SimulatedPlant does, and if the loop receives no positions.
    void run_to(double time_s, const std::function<void(const ClosedLoopInstant&)>& on_tick);

    const ControlLoop& loop() const noexcept { return *loop_; }
    /// Returns the first reaction to each push within 3 s after its begin.
    const std::vector<PushReaction>& reactions() const noexcept { return reactions_; }
    /// Enables or disables the learned torque; see FeedForward.
    void enable_learned(bool on) noexcept { loop_->enable_learned(on); }
    SimulatedPlant& plant() noexcept { return plant_; }

  private:
    /// The simulated wire and its two ends.
    struct Link {
        Link(const BusDescription& bus, const Scenario& scenario);

        MemoryBus loop_end, plant_end;
        LossyBus<MemoryBus> devices;
        LoopPort loop;
        PlantPort plant;
    };
    /// Readings of a direct connection without a bus.
    struct Readings {
        std::int64_t time_ns = 0;
        bool fresh = false; ///< not used yet
        JointVector position, torque;
    };

    /// Time of the motion, s; 0 until it begins.
    double motion_time(std::int64_t tick) const { return static_cast<double>(tick - waited_) * period_s_; }
    /// Time of the clock that schedules the ticks.
    std::int64_t pace_ns(std::int64_t tick) const;
    const LinkFaults& faults_at(double motion_time_s);
    std::int64_t begin_ns();
    /// Records the start of each push and the loop's first reaction to it.
    void note_reaction(double time_s);
    void measure();
    LoopInput sense(std::int64_t due_ns, std::int64_t now_ns);
    void command(std::int64_t now_ns, const JointVector& torque);
    void check_waiting() const;

    double period_s_;
    std::unique_ptr<Link> link_; ///< null: readings and torques pass directly
    std::unique_ptr<ControlLoop> loop_;
    SimulatedPlant plant_;
    FaultSchedule faults_;
    Losses losses_; ///< used without a bus
    static constexpr double longest_reaction_s = 3;

    std::vector<PushReaction> reactions_;
    std::size_t known_actions_ = 0;
    bool pushed_ = false;
    bool answered_ = true;                ///< the loop has reacted to the last push
    double push_s_ = -longest_reaction_s; ///< begin of the last push
    Readings readings_;
    std::int64_t bus_set_ns_ = 0; ///< offset of the loop's clock from the clock that schedules the ticks
    std::int64_t tick_ = 0, waited_ = 0;        ///< all ticks, and those before the motion
    std::int64_t cycle_ = 0;                    ///< of the devices' next reading
    std::int64_t begun_ns_ = 0;                 ///< start of the last tick
    std::deque<JointVector> position_when_due_; ///< true position, rad, of the ticks from the next one on
};

} // namespace dfdyn::tools
