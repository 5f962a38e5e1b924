// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/sampler.hpp"
#include "dfdyn/hal/bus_event.hpp"
#include "tests/hal/campaign/effects.hpp"
#include "tests/hal/campaign/judge.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

namespace dfdyn::tests {

/// Result for one family and trigger.
struct CampaignRow {
    std::string family;
    Trigger trigger = Trigger::timer;
    std::uint64_t frames = 0, faults = 0, samples = 0, accepted = 0, outputs = 0;
    std::uint64_t wrong_positions = 0, wrong_outputs = 0;
    std::uint64_t undecidable_positions = 0, undecidable_outputs = 0; ///< samples; see Match
    std::uint64_t good = 0;           ///< samples outside of every fault and its recovery
    std::uint64_t refused_good = 0;   ///< good samples without positions
    std::uint64_t unlearned_good = 0; ///< good samples with positions and without an output that was due
    FaultCounts effects;
    std::vector<std::uint64_t> wrong_by_fault;   ///< by the last fault that began before
    std::vector<std::uint64_t> refused_by_fault; ///< good samples, by the same fault
    std::vector<std::string> wrong, refused;     ///< descriptions of the first ones
};

/// Applies random mixtures of faults to the bus of one arm, and compares every accepted value with the truth.
class Campaign {
  public:
    /// `encoder`: the receiver's description of both encoders.
    Campaign(const CampaignArm& arm, Trigger trigger, hal::Encoder encoder, std::mt19937_64& engine)
        : arm_(arm), encoder_(encoder), engine_(engine) {
        row_.family = arm.name;
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
    /// A sample with the sampler's time and the true time.
    struct Unjudged {
        CampaignSample sample;
        std::int64_t now_ns, true_ns;
        std::int64_t heard_ns; ///< true time without the silences
    };

    static constexpr std::int64_t second = 1'000'000'000;
    static constexpr std::int64_t forever_ns = std::numeric_limits<std::int64_t>::max();
    static constexpr int cycles = 1500;
    static constexpr std::int64_t clock_shows_ns = 60 * bus_period; ///< duration of a step's effect
    static constexpr std::int64_t start_up_ns = 60 * bus_period;

    static std::int64_t nanoseconds(double time_s) { return static_cast<std::int64_t>(1e9 * time_s); }

    /// Returns the longest pending recovery when a fault begins, including its own.
    static std::int64_t recovery_ns(std::span<const PlacedFault> before, const Fault& fault,
                                    std::int64_t begin_ns) {
        std::int64_t longest_ns = nanoseconds(fault.recovery_s);
        for (const PlacedFault& placed : before) {
            const bool over = placed.fault->stays || begin_ns > placed.recovered_ns;
            longest_ns = over ? longest_ns : std::max(longest_ns, placed.recovered_ns - placed.end_ns);
        }
        return longest_ns;
    }

    /// Places faults one after another; half of them begin during the one before.
    std::vector<PlacedFault> place(const Scene& scene, std::span<const Fault> faults) {
        std::vector<PlacedFault> placed;
        std::uniform_real_distribution<double> unit(0, 1);
        std::int64_t at_ns = scene.cycle_ns(0) + start_up_ns + nanoseconds(0.3 * unit(engine_));
        std::int64_t free_ns = 0; // end of all earlier faults and their recoveries
        while (std::max(at_ns, free_ns) < scene.cycle_ns(cycles) - second / 2) {
            const Fault& fault =
                faults[std::uniform_int_distribution<std::size_t>(0, faults.size() - 1)(engine_)];
            const double length_s = fault.shortest_s + (fault.longest_s - fault.shortest_s) * unit(engine_);
            const std::int64_t end_ns = at_ns + nanoseconds(length_s);
            const std::int64_t recovered_ns = end_ns + recovery_ns(placed, fault, at_ns);
            free_ns = std::max(free_ns, recovered_ns + nanoseconds(0.1));
            placed.push_back({&fault, at_ns, end_ns, fault.stays ? forever_ns : recovered_ns});
            at_ns = unit(engine_) < 0.5 ? at_ns + nanoseconds(0.5 * length_s * unit(engine_))
                                        : free_ns + nanoseconds(0.4 * unit(engine_));
        }
        return placed;
    }

    void run_once(std::span<const Fault> faults) {
        Scene scene{Truth(engine_), 100 * second, &engine_};
        limits_ = std::bernoulli_distribution(0.5)(engine_) ? own_limits : hal::MotionLimits{};
        limits_.encoder = encoder_;
        Traffic traffic = arm_.run(scene, cycles);
        placed_ = place(scene, faults);
        described_ = nullptr;
        for (PlacedFault& placed : placed_) {
            const Traffic before = traffic;
            FaultSite site{arm_, traffic, placed.begin_ns, placed.end_ns, engine_, scene.truth};
            placed.fault->apply(site);
            placed.begin_ns = site.begin_ns; // some faults wait for motion
            const Fault& fault = *placed.fault;
            add(row_.effects[fault.number],
                {1, can_have(arm_, fault) ? 1U : 0U, same_frames(before, traffic) ? 0U : 1U});
        }
        row_.faults += placed_.size();
        const FaultSite all{arm_, traffic, 0, 0, engine_, scene.truth};
        sight_ = {JointSight(all, 0), JointSight(all, 1)};
        feed(scene, traffic);
    }

    void feed(const Scene& scene, const Traffic& traffic) {
        const std::unique_ptr<ReceivingArm> arm = arm_.receive(row_.trigger, limits_);
        hal::Sampler<ReceivingArm> sampler({.timer = row_.trigger == Trigger::timer,
                                            .period_ns = bus_period,
                                            .delay_ns = timer_delay,
                                            .patience_ns = 3 * bus_period});
        hal::BusState state = hal::BusState::active;
        hal::BusCounters counters;
        std::deque<Unjudged> samples;
        std::int64_t now_ns = scene.start_ns;
        std::int64_t heard_ns = 0;
        errors_.clear();
        for (const Sent& sent : traffic) {
            hal::note_frame(sent.frame, state, counters);
            ++row_.frames;
            heard_ns += std::clamp<std::int64_t>(sent.true_ns - now_ns, 0, bus_period);
            now_ns = sent.true_ns;
            sampler.take(*arm, sent.frame, state, counters, [&](const auto& sample, std::int64_t time_ns) {
                samples.push_back({sample, time_ns, now_ns, heard_ns});
            });
            note_error(sent.clock_ns + sampler.clock().offset_ns(), heard_ns);
            for (; !samples.empty() && samples.front().heard_ns + clock_shows_ns < heard_ns;
                 samples.pop_front()) {
                judge(scene, samples.front());
            }
        }
        for (const Unjudged& sample : samples) {
            judge(scene, sample);
        }
    }

    void note_error(std::int64_t error_ns, std::int64_t heard_ns) {
        if (errors_.empty() || error_ns != errors_.back().error_ns) {
            errors_.push_back({error_ns, heard_ns});
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
    /// Returns true if an output has just frozen, or is frozen and has just returned from another fault.
    bool undetectable_at(std::int64_t time_ns) const {
        const auto begins = [&](std::int64_t begin_ns, double undetectable_s) {
            return time_ns >= begin_ns - bus_period &&
                   time_ns <= begin_ns + nanoseconds(undetectable_s) + bus_period;
        };
        return std::ranges::any_of(placed_, [&](const PlacedFault& frozen) {
            const double undetectable_s = frozen.fault->undetectable_s;
            const bool comes_back = std::ranges::any_of(placed_, [&](const PlacedFault& other) {
                return other.end_ns > frozen.begin_ns && other.end_ns < frozen.end_ns &&
                       begins(other.end_ns, undetectable_s + 0.01);
            });
            return begins(frozen.begin_ns, undetectable_s) || (undetectable_s > 0 && comes_back);
        });
    }

    void judge(const Scene& scene, const Unjudged& unjudged) {
        const auto& [sample, now_ns, true_ns, heard_ns] = unjudged;
        ++row_.samples;
        const bool good = !in_own_time(true_ns) && true_ns > scene.cycle_ns(0) + start_up_ns;
        row_.good += good ? 1 : 0;
        const PlacedFault* const fault = fault_at(true_ns);
        const auto number = static_cast<std::size_t>(fault == nullptr ? 0 : fault->fault->number);
        if (!sample.valid) {
            row_.refused_good += good ? 1 : 0;
            row_.refused_by_fault[number] += good ? 1 : 0;
            if (good) {
                describe(scene, unjudged, row_.refused);
            }
            return;
        }
        ++row_.accepted;
        const Judge judge(arm_, scene.truth, limits_, placed_, sight_);
        Match position = Match::wrong;
        Match output = sample.output_valid && !undetectable_at(true_ns) ? Match::wrong : Match::right;
        for (const ErrorRange& error : errors_at(heard_ns)) {
            position = std::max(position, match_positions(judge, unjudged, error));
            output =
                std::max(output, output == Match::right ? output : match_outputs(judge, unjudged, error));
        }
        row_.outputs += sample.output_valid ? 1 : 0;
        row_.wrong_positions += position == Match::wrong ? 1 : 0;
        row_.wrong_outputs += output == Match::wrong ? 1 : 0;
        row_.undecidable_positions += position == Match::undecidable ? 1 : 0;
        row_.undecidable_outputs += output == Match::undecidable ? 1 : 0;
        if (position == Match::wrong || output == Match::wrong) {
            ++row_.wrong_by_fault[number];
            wrong_kind_ = position == Match::wrong ? "position" : "output";
            describe(scene, unjudged, row_.wrong);
        }
        const bool due = sample.report.output != hal::Reason::output_not_new;
        row_.unlearned_good += good && due && !sample.output_valid ? 1 : 0;
    }

    /// Describes the accepted values, the true ones and the faults so far.
    void describe(const Scene& scene, const Unjudged& unjudged, std::vector<std::string>& list) {
        constexpr std::size_t most = 20;
        if (list.size() == most || described_ == &list) {
            return;
        }
        described_ = &list;
        const auto& [sample, now_ns, true_ns, heard_ns] = unjudged;
        const auto seconds = [&](std::int64_t time_ns) { return seconds_of(time_ns - scene.start_ns); };
        const std::int64_t error_ns = errors_at(heard_ns).front().least_ns;
        std::ostringstream text;
        text << wrong_kind_ << " at " << seconds(true_ns) << " s:";
        for (std::size_t i = 0; i < Truth::joints; ++i) {
            const hal::ValueOrigin origin = sample.report.position_origin[i];
            const std::int64_t time_ns =
                origin == hal::ValueOrigin::held ? now_ns - sample.report.position_age_ns[i] : sample.time_ns;
            const Claim claim{sample.position[i], seconds_of(time_ns - error_ns), 0, origin};
            const auto [off, limit] = Judge(arm_, scene.truth, limits_, placed_, sight_).explain(i, claim);
            text << " joint " << i + 1 << ' ' << sample.position[i] << " not "
                 << scene.truth.position(i, seconds_of(time_ns - error_ns)) << ", off by " << off << " where "
                 << limit << " is undecidable (" << hal::name(sample.report.joint_reason[i])
                 << "; its readings were right until " << seconds_of(sight_[i].run_at(true_ns).blind_ns)
                 << " s before " << seconds(sight_[i].run_at(true_ns).begin_ns) << ", then off by "
                 << sight_[i].run_at(true_ns).error_rad << ", from zero by "
                 << sight_[i].run_at(true_ns).from_zero_rad << ")";
        }
        for (const PlacedFault& placed : placed_) {
            if (placed.begin_ns <= true_ns) {
                text << "; fault " << placed.fault->number << " from " << seconds(placed.begin_ns) << " to "
                     << seconds(placed.end_ns);
            }
        }
        list.push_back(text.str());
    }

    /// Returns the errors of the sampler's time at a time without silences. A clock step affects samples for
    /// a while. A value between two measurements, before and after the step, has an error between the two.
    std::vector<ErrorRange> errors_at(std::int64_t heard_ns) const {
        std::vector<ErrorRange> errors;
        for (std::size_t i = 0; i < errors_.size(); ++i) {
            const auto [error_ns, since_ns] = errors_[i];
            const bool gone = i + 1 < errors_.size() && errors_[i + 1].since_ns + clock_shows_ns < heard_ns;
            const bool known = std::ranges::any_of(errors, [here = error_ns](const ErrorRange& error) {
                return error.range_ns == 0 && error.least_ns == here;
            });
            if (gone || known || since_ns > heard_ns + clock_shows_ns) {
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

    /// Returns the worst match of the joints, for a clock with this error. A held value belongs to the time
    /// of its reading, which follows from its age in the report.
    static Match match_positions(const Judge& judge, const Unjudged& unjudged, const ErrorRange& error) {
        const auto& [sample, now_ns, true_ns, heard_ns] = unjudged;
        Match all = Match::right;
        for (std::size_t i = 0; i < Truth::joints; ++i) {
            const hal::ValueOrigin origin = sample.report.position_origin[i];
            const std::int64_t time_ns =
                origin == hal::ValueOrigin::held ? now_ns - sample.report.position_age_ns[i] : sample.time_ns;
            const Claim claim{sample.position[i], seconds_of(time_ns - error.least_ns),
                              seconds_of(error.range_ns), origin};
            all = std::min(all, judge.position(i, claim, true_ns));
        }
        return all;
    }

    static Match match_outputs(const Judge& judge, const Unjudged& unjudged, const ErrorRange& error) {
        const auto& [sample, now_ns, true_ns, heard_ns] = unjudged;
        const hal::ValueOrigin origin = sample.report.output_origin;
        const std::int64_t time_ns =
            origin == hal::ValueOrigin::held ? now_ns - sample.report.output_age_ns : sample.time_ns;
        Match all = Match::right;
        for (std::size_t k = 0; k < sample.outputs; ++k) {
            const Claim claim{sample.output[k], seconds_of(time_ns - error.least_ns),
                              seconds_of(error.range_ns), origin};
            all = std::min(all, judge.output(k, claim, true_ns));
        }
        return all;
    }

    const CampaignArm& arm_;
    hal::Encoder encoder_;
    std::mt19937_64& engine_;
    hal::MotionLimits limits_;
    CampaignRow row_;
    std::vector<PlacedFault> placed_;
    std::vector<JointSight> sight_;
    const char* wrong_kind_ = "";
    const std::vector<std::string>* described_ = nullptr; ///< list with a sample of this run
    struct ClockError {
        std::int64_t error_ns;
        std::int64_t since_ns;
    };
    std::vector<ClockError> errors_;
};

} // namespace dfdyn::tests
