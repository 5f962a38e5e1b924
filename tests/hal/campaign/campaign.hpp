// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/sampler.hpp"
#include "dfdyn/hal/bus_event.hpp"
#include "tests/hal/campaign/faults.hpp"

#include <deque>
#include <optional>
#include <vector>

namespace dfdyn::tests {

/// What came of one family and trigger.
struct CampaignRow {
    const char* family = "";
    Trigger trigger = Trigger::timer;
    std::uint64_t frames = 0, faults = 0, samples = 0, accepted = 0, outputs = 0;
    std::uint64_t wrong_positions = 0, wrong_outputs = 0;
    std::uint64_t good = 0;           ///< samples outside of every fault's own time
    std::uint64_t refused_good = 0;   ///< of them: without positions
    std::uint64_t unlearned_good = 0; ///< of them: with positions and without an output, where it is due
    std::vector<std::uint64_t> wrong_by_fault;   ///< of the last fault that began before
    std::vector<std::uint64_t> refused_by_fault; ///< likewise, of good samples
};

/// A fault in its place.
struct PlacedFault {
    const Fault* fault;
    std::int64_t begin_ns, end_ns;
};

/// An assembly as a Sampler takes it.
template <class Assembly>
struct ArmOfSampler {
    Assembly assembly;
    Trigger trigger;

    std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) {
        using Kind = hal::SampleMoment::Kind;
        const hal::SampleMoment moment = assembly.take(frame, now_ns);
        const Kind wanted = trigger == Trigger::sync ? Kind::sync : Kind::set;
        return trigger != Trigger::timer && moment.kind == wanted ? std::optional(moment.instant_ns)
                                                                  : std::nullopt;
    }
    void update(hal::BusState state, const hal::BusCounters& counters) { assembly.update(state, counters); }
    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const {
        return assembly.pending(instant_ns, now_ns);
    }
    auto assemble(std::int64_t instant_ns, std::int64_t now_ns) {
        return assembly.assemble(instant_ns, now_ns);
    }
};

/// Puts random mixtures of faults on the bus of one kind of arm, and compares every accepted value with the
/// truth.
template <class Arm>
class Campaign {
  public:
    Campaign(Trigger trigger, std::mt19937_64& engine) : engine_(engine) {
        row_.family = Arm::name;
        row_.trigger = trigger;
        row_.wrong_by_fault.resize(100);
        row_.refused_by_fault.resize(100);
    }

    CampaignRow run(std::uint64_t frames, std::span<const Fault> faults) {
        while (row_.frames < frames) {
            run_once(faults);
        }
        return row_;
    }

  private:
    static constexpr std::int64_t second = 1'000'000'000;
    static constexpr int cycles = 1500;
    static constexpr std::int64_t clock_shows_ns = 60 * bus_period; ///< after it was set
    static constexpr std::int64_t start_up_ns = 60 * bus_period;

    static std::int64_t nanoseconds(double time_s) { return static_cast<std::int64_t>(1e9 * time_s); }

    /// One fault after the other, at times two at once; one that stays ends the run.
    std::vector<PlacedFault> place(const Scene& scene, std::span<const Fault> faults) {
        std::vector<PlacedFault> placed;
        std::uniform_real_distribution<double> unit(0, 1);
        std::int64_t at_ns = scene.cycle_ns(0) + start_up_ns + nanoseconds(0.3 * unit(engine_));
        std::int64_t free_ns = 0; // of all faults before, recovered
        while (std::max(at_ns, free_ns) < scene.cycle_ns(cycles) - second / 2) {
            const Fault& fault =
                faults[std::uniform_int_distribution<std::size_t>(0, faults.size() - 1)(engine_)];
            const bool mixes_with_all = std::ranges::all_of(placed, [&](const PlacedFault& one) {
                const bool over = one.end_ns + nanoseconds(one.fault->recovery_s + 0.1) < at_ns;
                return over || mix(one.fault->effect, fault.effect);
            });
            at_ns = mixes_with_all ? at_ns : std::max(at_ns, free_ns);
            const double length_s = fault.shortest_s + (fault.longest_s - fault.shortest_s) * unit(engine_);
            const std::int64_t end_ns =
                fault.ends ? at_ns + nanoseconds(length_s) : scene.cycle_ns(cycles + 1);
            placed.push_back({&fault, at_ns, end_ns});
            free_ns = std::max(free_ns, end_ns + nanoseconds(fault.recovery_s + 0.1));
            if (!fault.ends) {
                break;
            }
            at_ns = unit(engine_) < 0.5 ? at_ns + nanoseconds(0.5 * length_s * unit(engine_))
                                        : free_ns + nanoseconds(0.4 * unit(engine_));
        }
        return placed;
    }

    void run_once(std::span<const Fault> faults) {
        Scene scene{Truth(engine_), 100 * second, &engine_};
        limits_ = std::bernoulli_distribution(0.5)(engine_) ? own_limits : hal::MotionLimits{};
        Traffic traffic;
        Arm::start(scene, traffic);
        for (int k = 0; k < cycles; ++k) {
            Arm::cycle(scene, k, traffic);
        }
        std::ranges::stable_sort(traffic, {}, &Sent::true_ns);
        placed_ = place(scene, faults);
        for (PlacedFault& placed : placed_) {
            FaultSite site{traffic, placed.begin_ns, placed.end_ns, engine_, scene.truth};
            placed.fault->apply(site);
            placed.begin_ns = site.begin_ns; // some wait for motion
        }
        row_.faults += placed_.size();
        feed(scene, traffic);
    }

    void feed(const Scene& scene, const Traffic& traffic) {
        using Assembly = typename Arm::Assembly;
        using Adapter = ArmOfSampler<Assembly>;
        Adapter arm{Arm::make(limits_), row_.trigger};
        hal::Sampler<Adapter> sampler({.timer = row_.trigger == Trigger::timer,
                                       .period_ns = bus_period,
                                       .delay_ns = timer_delay,
                                       .patience_ns = 3 * bus_period});
        hal::BusState state = hal::BusState::active;
        hal::BusCounters counters;
        struct Unjudged {
            typename Assembly::Assembled assembled;
            std::int64_t true_ns;
        };
        std::deque<Unjudged> samples;
        std::int64_t now_ns = 0;
        errors_.clear();
        for (const Sent& sent : traffic) {
            hal::note_frame(sent.frame, state, counters);
            ++row_.frames;
            now_ns = sent.true_ns;
            sampler.take(arm, sent.frame, state, counters, [&](const auto& assembled, std::int64_t) {
                samples.push_back({assembled, now_ns});
            });
            note_error(sent.frame.stamp_ns + sampler.clock().offset_ns() - now_ns, now_ns);
            for (; !samples.empty() && samples.front().true_ns + clock_shows_ns < now_ns;
                 samples.pop_front()) {
                judge(scene, samples.front().assembled, samples.front().true_ns);
            }
        }
        for (const Unjudged& sample : samples) {
            judge(scene, sample.assembled, sample.true_ns);
        }
    }

    /// Of the sampler's time against the truth; a stray stamp is not the clock's.
    void note_error(std::int64_t error_ns, std::int64_t true_ns) {
        const bool steady = std::abs(error_ns - last_error_ns_) < 100 * bus_us;
        last_error_ns_ = error_ns;
        if (steady && (errors_.empty() || std::abs(error_ns - errors_.back().error_ns) > 100 * bus_us)) {
            errors_.push_back({error_ns, true_ns});
        }
    }

    const PlacedFault* fault_at(std::int64_t time_ns) const {
        const PlacedFault* last = nullptr;
        for (const PlacedFault& placed : placed_) {
            if (placed.begin_ns - 5 * bus_period <= time_ns) {
                last = &placed;
            }
        }
        return last;
    }
    bool in_own_time(std::int64_t time_ns) const {
        return std::ranges::any_of(placed_, [&](const PlacedFault& placed) {
            return time_ns >= placed.begin_ns - 5 * bus_period &&
                   time_ns <= placed.end_ns + nanoseconds(placed.fault->recovery_s);
        });
    }
    /// By how much stamps of that time may be late, beyond the jitter.
    double delay_at(std::int64_t time_ns) const {
        double delay_s = 0;
        for (const PlacedFault& placed : placed_) {
            const bool covers = time_ns >= placed.begin_ns - 5 * bus_period &&
                                time_ns <= placed.end_ns + nanoseconds(placed.fault->recovery_s);
            delay_s = covers ? std::max(delay_s, placed.fault->delay_s) : delay_s;
        }
        return delay_s;
    }
    bool undetectable_at(std::int64_t time_ns) const {
        return std::ranges::any_of(placed_, [&](const PlacedFault& placed) {
            return time_ns >= placed.begin_ns - bus_period &&
                   time_ns <= placed.begin_ns + nanoseconds(placed.fault->undetectable_s) + bus_period;
        });
    }

    template <class Assembled>
    void judge(const Scene& scene, const Assembled& assembled, std::int64_t true_ns) {
        ++row_.samples;
        const bool good = !in_own_time(true_ns) && true_ns > scene.cycle_ns(0) + start_up_ns;
        row_.good += good ? 1 : 0;
        const PlacedFault* const fault = fault_at(true_ns);
        const auto number = static_cast<std::size_t>(fault == nullptr ? 0 : fault->fault->number);
        if (!assembled.valid()) {
            row_.refused_good += good ? 1 : 0;
            row_.refused_by_fault[number] += good ? 1 : 0;
            return;
        }
        ++row_.accepted;
        bool position = false;
        bool output = !assembled.sample.output_valid || undetectable_at(true_ns);
        for (std::size_t i = 0; i < errors_.size(); ++i) {
            if (i + 1 < errors_.size() && errors_[i + 1].since_ns + clock_shows_ns < true_ns) {
                continue; // that clock is long gone
            }
            if (errors_[i].since_ns > true_ns + clock_shows_ns) {
                break;
            }
            const std::int64_t time_ns = assembled.sample.time_ns - errors_[i].error_ns;
            position = position || right_position(scene.truth, assembled, time_ns);
            output = output || right_output(scene, assembled, time_ns);
        }
        row_.wrong_positions += position ? 0 : 1;
        row_.outputs += assembled.sample.output_valid ? 1 : 0;
        row_.wrong_outputs += output ? 0 : 1;
        row_.wrong_by_fault[number] += position && output ? 0 : 1;
        const bool due = assembled.report.output != hal::Reason::output_not_new;
        row_.unlearned_good += good && due && !assembled.sample.output_valid ? 1 : 0;
    }

    /// How long before its stamp a value may have been measured: by the jitter of its frame and that of the
    /// one before, which says where this one must be; a held value is up to a period and a quarter older.
    double earliest_s(hal::ValueOrigin origin, std::int64_t time_ns) const {
        const double held_s = origin == hal::ValueOrigin::held ? 1.25 * seconds_of(bus_period) : 0;
        return 0.6e-3 + held_s + delay_at(time_ns);
    }
    double latest_s(std::int64_t time_ns) const { return 0.6e-3 + delay_at(time_ns); }

    /// What a motion within the limits may do unseen, from one reading to the next that is trusted: `max_age`
    /// and twice the jitter later, after four readings.
    double unseen_rad() const {
        const double jitter_s = seconds_of(bus_jitter + 50 * bus_us);
        const double age_s = seconds_of(bus_max_age) + 2 * jitter_s;
        const double change = 2 * limits_.acceleration * age_s; // of the velocity
        return limits_.acceleration * age_s * age_s * 13 / 12 + 2.25 * (Arm::step + change * jitter_s);
    }

    template <class Assembled>
    bool right_position(const Truth& truth, const Assembled& assembled, std::int64_t time_ns) const {
        bool all = true;
        for (std::size_t i = 0; i < Truth::joints; ++i) {
            const double found = assembled.sample.position[static_cast<int>(i)];
            const double earliest = earliest_s(assembled.report.position_origin[i], time_ns);
            bool right = false;
            for (double late = latest_s(time_ns); late >= -earliest && !right; late -= 0.1e-3) {
                right = std::abs(found - truth.position(i, seconds_of(time_ns) + late)) <= unseen_rad();
            }
            all = all && right;
        }
        return all;
    }

    template <class Assembled>
    bool right_output(const Scene& scene, const Assembled& assembled, std::int64_t time_ns) const {
        const double earliest = earliest_s(assembled.report.output_origin, time_ns);
        for (double late = latest_s(time_ns); late >= -earliest; late -= 0.1e-3) {
            if (right_output_at(scene.truth, assembled, seconds_of(time_ns) + late)) {
                return true;
            }
        }
        return false;
    }
    /// To the noise, the chord between two measurements, and what the jump gate cannot tell.
    template <class Assembled>
    bool right_output_at(const Truth& truth, const Assembled& assembled, double time_s) const {
        const double age_s = seconds_of(bus_max_age);
        bool all = true;
        for (std::size_t k = 0; k < static_cast<std::size_t>(assembled.sample.output.size()); ++k) {
            const double found = assembled.sample.output[static_cast<int>(k)];
            const double expected =
                Arm::efforts ? truth.effort(k, time_s) : Arm::output_range * truth.load(k, time_s);
            const double range = Arm::efforts ? 8 : 0.2 * Arm::output_range;
            const double chord = range * 20 * 20 * age_s * age_s / 8;
            all = all && std::abs(found - expected) <= chord + 0.12 * range;
        }
        return all;
    }

    std::mt19937_64& engine_;
    hal::MotionLimits limits_;
    CampaignRow row_;
    std::vector<PlacedFault> placed_;
    struct ClockError {
        std::int64_t error_ns;
        std::int64_t since_ns;
    };
    std::vector<ClockError> errors_;
    std::int64_t last_error_ns_ = 0;
};

} // namespace dfdyn::tests
