// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_can.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/description/bus_fields.hpp"
#include "tools/can/log/candump_log.hpp"

#include <cmath>
#include <ostream>
#include <utility>

namespace dfdyn::tools {

namespace {

void check_fit(const TrainedModel& model, const BusDescription& description) {
    const auto refuse = [&](const std::string& field, const std::string& expected, const std::string& found) {
        throw InputError(description.source + ": " + field + ": expected " + expected +
                         ", as of the model, found " + found);
    };
    if (description.joint_count != model.joints) {
        refuse("joints", std::to_string(model.joints), std::to_string(description.joint_count));
    }
    const auto names = output_names(description.outputs, static_cast<std::size_t>(description.joint_count));
    if (names != model.outputs.names) {
        refuse("output", listed(model.outputs.names), listed(names));
    }
    const double rate_hz = 1 / model.sample_period_s;
    if (std::abs(description.sample_rate_hz / rate_hz - 1) > 0.01) {
        refuse("sample_rate_hz", number_text(rate_hz), number_text(description.sample_rate_hz));
    }
    if (needs_derivatives(model)) {
        throw InputError(description.source + ": expected a model without measured derivatives, which no bus "
                                              "has, found one with");
    }
}

void print(std::ostream& out, const char* what, const hal::UnexpectedFrames& offenders) {
    if (offenders.count() == 0) {
        return;
    }
    const hal::UnexpectedFrames::Entry& first = offenders.first();
    out << "  " << offenders.count() << " x " << what << ": first " << identifier_text(first.id) << " with "
        << static_cast<int>(first.length) << " bytes";
    if (first.reason != hal::Reason::ok) {
        out << ", " << hal::name(first.reason);
    }
    out << '\n';
}

void print(std::ostream& out, const char* what, std::uint64_t count) {
    if (count > 0) {
        out << "  " << count << " x " << what << '\n';
    }
}

} // namespace

CanReplayer::CanReplayer(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                         const BusDescription& description, std::string source, std::size_t horizon,
                         const ReplayMemory& memory)
    : replayer_(estimator, std::move(source), models.front().outputs.names.size(), horizon, memory),
      sampler_(description, [this](const BusSample& sample) { tick(sample); }) {
    for (const TrainedModel& model : models) {
        check_fit(model, description);
    }
    estimator.begin_recording();
}

void CanReplayer::tick(const BusSample& sample) {
    const std::int64_t time_ns = sample.sample.time_ns;
    const double time_s = 1e-9 * static_cast<double>(time_ns - sampler_.start_ns());
    if (!sample.valid()) {
        replayer_.skip(time_s, sample.report.position);
        return;
    }
    replayer_.tick(time_s, {time_ns, sample.positions(), {}, {}, sample.valid_outputs()},
                   sample.report.output);
}

ReplayedBus CanReplayer::finish(const hal::BusCounters& counters) {
    sampler_.finish();
    const hal::BusWatch& watch = sampler_.arm().bus();
    return {replayer_.finish(),
            {sampler_.frames(), counters, watch.unknown, watch.rejected, sampler_.strays(),
             sampler_.late_moments()}};
}

ReplayedBus replay_log(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                       const BusDescription& description, const std::filesystem::path& log,
                       const std::string& log_interface, std::size_t horizon) {
    CanReplayer replayer(estimator, models, description, shown(log), horizon);
    CandumpLog frames(log, log_interface);
    hal::ReplayBus bus(frames);
    std::array<hal::Frame, 1> one;
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        for (const hal::Frame& frame : bus.drain(one)) {
            replayer.sampler().take(frame, bus.state(), bus.counters());
        }
    }
    frames.check();
    warn_of_torn_line(frames);
    if (!replayer.sampler().started()) {
        throw InputError(shown(log) + ": expected frames, found none");
    }
    return replayer.finish(bus.counters());
}

void print_bus(std::ostream& out, const BusFigures& figures) {
    out << "bus: " << figures.frames << " frames\n";
    print(out, "frames with identifiers that the description does not have", figures.unknown);
    print(out, "frames with invalid content", figures.rejected);
    print(out, "frames left out, with stamps ahead of those after them", figures.strays);
    print(out, "triggers too late for a sample", figures.late_moments);
    print(out, "frames lost before they were read", figures.counters.dropped);
    print(out, "times that the controller lost frames", figures.counters.controller_overruns);
    print(out, "error frames", figures.counters.error_frames);
    print(out, "times bus-off", figures.counters.bus_off);
    print(out, "times the interface went down", figures.counters.interface_down);
}

} // namespace dfdyn::tools
