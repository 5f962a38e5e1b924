// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/sampler.hpp"
#include "dfdyn/hal/bus_event.hpp"
#include "tests/hal/campaign/judge.hpp"

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
    std::uint64_t unseen_positions = 0, unseen_outputs = 0; ///< see Match; samples
    std::uint64_t good = 0;                                 ///< samples outside of every fault's own time
    std::uint64_t refused_good = 0;                         ///< of them: without positions
    std::uint64_t unlearned_good = 0; ///< of them: with positions and without an output, where it is due
    std::vector<std::uint64_t> wrong_by_fault;   ///< of the last fault that began before
    std::vector<std::uint64_t> refused_by_fault; ///< likewise, of good samples
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
    struct ErrorRange {
        std::int64_t least_ns, range_ns;
    };
    /// A sample with the sampler's time and the true one.
    struct Unjudged {
        typename Arm::Assembly::Assembled assembled;
        std::int64_t now_ns, true_ns;
    };

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
        std::deque<Unjudged> samples;
        std::int64_t now_ns = 0;
        errors_.clear();
        for (const Sent& sent : traffic) {
            hal::note_frame(sent.frame, state, counters);
            ++row_.frames;
            now_ns = sent.true_ns;
            sampler.take(arm, sent.frame, state, counters, [&](const auto& assembled, std::int64_t time_ns) {
                samples.push_back({assembled, time_ns, now_ns});
            });
            note_error(sent.clock_ns + sampler.clock().offset_ns(), now_ns);
            for (; !samples.empty() && samples.front().true_ns + clock_shows_ns < now_ns;
                 samples.pop_front()) {
                judge(scene, samples.front());
            }
        }
        for (const Unjudged& sample : samples) {
            judge(scene, sample);
        }
    }

    void note_error(std::int64_t error_ns, std::int64_t true_ns) {
        if (errors_.empty() || error_ns != errors_.back().error_ns) {
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
        return std::ranges::any_of(placed_,
                                   [&](const PlacedFault& placed) { return placed.covers(time_ns); });
    }
    bool undetectable_at(std::int64_t time_ns) const {
        return std::ranges::any_of(placed_, [&](const PlacedFault& placed) {
            return time_ns >= placed.begin_ns - bus_period &&
                   time_ns <= placed.begin_ns + nanoseconds(placed.fault->undetectable_s) + bus_period;
        });
    }

    void judge(const Scene& scene, const Unjudged& sample) {
        const auto& [assembled, now_ns, true_ns] = sample;
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
        const bool output_valid = assembled.sample.output_valid;
        const Judge<Arm> judge(scene.truth, limits_, placed_);
        Match position = Match::wrong;
        Match output = output_valid && !undetectable_at(true_ns) ? Match::wrong : Match::right;
        for (const ErrorRange& error : errors_at(true_ns)) {
            position = std::max(position, match_positions(judge, sample, error));
            output = std::max(output, output == Match::right ? output : match_outputs(judge, sample, error));
        }
        row_.outputs += output_valid ? 1 : 0;
        row_.wrong_positions += position == Match::wrong ? 1 : 0;
        row_.wrong_outputs += output == Match::wrong ? 1 : 0;
        row_.unseen_positions += position == Match::unseen ? 1 : 0;
        row_.unseen_outputs += output == Match::unseen ? 1 : 0;
        row_.wrong_by_fault[number] += position == Match::wrong || output == Match::wrong ? 1 : 0;
        const bool due = assembled.report.output != hal::Reason::output_not_new;
        row_.unlearned_good += good && due && !output_valid ? 1 : 0;
    }

    /// Of the sampler's time at that time. A clock that was set shows for a while after. A value between two
    /// measurements, one by the old clock and one by the new, is of an instant between.
    std::vector<ErrorRange> errors_at(std::int64_t true_ns) const {
        std::vector<ErrorRange> errors;
        for (std::size_t i = 0; i < errors_.size(); ++i) {
            const auto [error_ns, since_ns] = errors_[i];
            const bool gone = i + 1 < errors_.size() && errors_[i + 1].since_ns + clock_shows_ns < true_ns;
            if (gone || since_ns > true_ns + clock_shows_ns) {
                continue;
            }
            for (std::size_t k = 0, before = errors.size(); k < before; ++k) {
                const std::int64_t other_ns = errors[k].least_ns;
                const std::int64_t apart_ns = std::abs(error_ns - other_ns);
                if (errors[k].range_ns == 0 && apart_ns <= bus_max_age) {
                    errors.push_back({std::min(error_ns, other_ns), apart_ns});
                }
            }
            errors.push_back({error_ns, 0});
        }
        return errors;
    }

    /// The least good of the joints, of a sample by a clock with that error. A held value is of its reading's
    /// instant, which the report tells.
    static Match match_positions(const Judge<Arm>& judge, const Unjudged& sample, const ErrorRange& error) {
        const auto& [assembled, now_ns, true_ns] = sample;
        Match all = Match::right;
        for (std::size_t i = 0; i < Truth::joints; ++i) {
            const hal::ValueOrigin origin = assembled.report.position_origin[i];
            const std::int64_t time_ns = origin == hal::ValueOrigin::held
                                             ? now_ns - assembled.report.position_age_ns[i]
                                             : assembled.sample.time_ns;
            const Claim claim{assembled.sample.position[static_cast<int>(i)],
                              seconds_of(time_ns - error.least_ns), seconds_of(error.range_ns), origin};
            all = std::min(all, judge.position(i, claim, true_ns));
        }
        return all;
    }

    static Match match_outputs(const Judge<Arm>& judge, const Unjudged& sample, const ErrorRange& error) {
        const auto& [assembled, now_ns, true_ns] = sample;
        const hal::ValueOrigin origin = assembled.report.output_origin;
        const std::int64_t time_ns = origin == hal::ValueOrigin::held
                                         ? now_ns - assembled.report.output_age_ns
                                         : assembled.sample.time_ns;
        Match all = Match::right;
        for (std::size_t k = 0; k < static_cast<std::size_t>(assembled.sample.output.size()); ++k) {
            const Claim claim{assembled.sample.output[static_cast<int>(k)],
                              seconds_of(time_ns - error.least_ns), seconds_of(error.range_ns), origin};
            all = std::min(all, judge.output(k, claim, true_ns));
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
};

} // namespace dfdyn::tests
