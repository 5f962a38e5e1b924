// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/loop_run.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/file_set.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/stop_signal.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/report/loop_peaks.hpp"
#include "tools/control/report/loop_recording.hpp"
#include "tools/control/report/loop_summary.hpp"
#include "tools/control/report/tracking_report.hpp"
#include "tools/model/file/model_file.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

struct LoopParts {
    Robot robot;
    Scenario scenario;
    std::optional<LoopModel> model;
    std::optional<BusDescription> bus;
};

LoopParts read_parts(const LoopOptions& options) {
    // A run may restore and save the learned state in the same file.
    check_outputs({options.saved, options.calibrated},
                  {options.robot, options.scenario, options.model, options.bus});
    LoopParts parts{read_scenario_robot(options.robot, options.scenario), {}, {}, {}};
    parts.scenario = read_scenario(options.scenario, parts.robot);
    if (!options.model.empty()) {
        parts.model = LoopModel{read_model(options.model), shown(options.model), options.from_prior};
    }
    if (!options.restored.empty()) {
        const std::string bytes = read_file(options.restored);
        const auto whole = std::as_bytes(std::span(bytes));
        parts.model->learned.assign(whole.begin(), whole.end());
        parts.model->learned_source = shown(options.restored);
    }
    if (parts.model) { // throws unless it fits: before the runs without it
        make_control_loop(parts.robot, parts.scenario, shown(options.scenario), &*parts.model);
    }
    if (!options.bus.empty()) {
        parts.bus = read_bus_description(options.bus);
        check_bus(*parts.bus, parts.robot, parts.scenario);
    }
    if (!options.folder.empty()) {
        check_folder(options.folder);
    }
    if (options.window_s * parts.scenario.controller.rate_hz < 1) {
        throw InputError("loop: --window: expected at least a period of the loop, " +
                         number_text(1 / parts.scenario.controller.rate_hz) + " s, found " +
                         number_text(options.window_s));
    }
    return parts;
}

/// Makes a recording with the rate of the scenario's `recording`.
LoopRecording make_recording(const LoopParts& parts, const LoopOptions& options) {
    const double rate_hz = parts.scenario.controller.rate_hz;
    const double ratio = rate_hz / parts.scenario.recording.rate_hz;
    if (!(ratio >= 0.999) || std::abs(ratio - std::round(ratio)) > 1e-6) {
        throw InputError(shown(options.scenario) +
                         ": recording.rate_hz: expected controller.rate_hz by a whole number, found " +
                         number_text(parts.scenario.recording.rate_hz));
    }
    constexpr double without_end_s = 600;
    return {static_cast<int>(parts.robot.joints.size()), static_cast<int>(std::lround(ratio)), 1 / rate_hz,
            options.duration_s > 0 ? options.duration_s : without_end_s};
}

/// Adds the recording of the run `name` if there is a folder for results.
void add_recording(const LoopOptions& options, const std::string& name, const LoopRecording& recording,
                   FileSet& files) {
    if (!options.folder.empty()) {
        files.add_folder(options.folder);
        recording.write(files.add(options.folder / (name + ".csv")));
    }
}

void show_tracking(const LoopParts& parts, const LoopOptions& options, const std::vector<TrackingRun>& runs,
                   FileSet& files) {
    print_tracking(std::cout, runs);
    if (!options.folder.empty()) {
        add_tracking(options.folder, "Tracking of " + parts.robot.name, runs, files);
    }
}

/// Prints the findings of the learner's monitor in a run, and adds them to those of other runs.
void show_changes(const std::string& run, const ControlLoop& loop, std::vector<RecordedChanges>& runs) {
    if (const LearnedFeedForward* const learned = loop.feed_forward().learned()) {
        runs.push_back(learned->changes(run));
        print_changes(std::cout, runs.back());
    }
}

/// Adds the findings in all runs as a file next to the tracking results.
void add_changes(const LoopOptions& options, const std::vector<RecordedChanges>& runs, FileSet& files) {
    if (!options.folder.empty() && !runs.empty()) {
        files.add(options.folder / "changes.json",
                  json_text(changes_json(runs, MonitorSetup().false_alarm_hours)) + '\n');
    }
}

/// Saves the learned state, except after a stop by the loop itself: the last samples may be faulty.
void save_learned(const LoopOptions& options, const ControlLoop& loop, FileSet& files) {
    const LearnedFeedForward* const learned = loop.feed_forward().learned();
    const bool sound = loop.state() == LoopState::running || loop.cause() == StopCause::requested;
    if (learned != nullptr && sound && !options.saved.empty()) {
        const std::vector<std::byte> snapshot = learned->snapshot();
        files.add(options.saved, {reinterpret_cast<const char*>(snapshot.data()), snapshot.size()});
    }
}

/// Writes the model with the limits of contacts that the loop has measured.
void save_calibrated(const LoopOptions& options, const LoopParts& parts, const ControlLoop& loop,
                     FileSet& files) {
    const LearnedFeedForward* const learned = loop.feed_forward().learned();
    if (options.calibrated.empty() || learned == nullptr || !learned->contact_calibration()->finished()) {
        return;
    }
    TrainedModel model = parts.model->model;
    model.contact = measured_contact(model.contact, *learned->contact_calibration(),
                                     options.limits.contact_rate_per_hour.value_or(contact_rate_per_hour));
    files.add(options.calibrated, model_to_json(model) + '\n');
}

/// Sources of torque in addition to the feedback and the nominal rigid body.
struct ComparedController {
    std::string name;
    bool observer = false;
    bool learned = false;
};

/// Returns whether the observer is enabled: a bandwidth of 0 disables it.
bool has_observer(const LoopOptions& options) {
    const std::vector<double>& given = options.limits.observer_bandwidth;
    return given.empty() || std::ranges::any_of(given, [](double bandwidth) { return bandwidth > 0; });
}

/// Returns the variants that a simulation compares, the complete one last.
std::vector<ComparedController> compared_controllers(const LoopOptions& options) {
    const bool observer = has_observer(options);
    std::vector<ComparedController> all{{"nominal", false, false}};
    if (observer) {
        all.push_back({"observer", true, false});
    }
    if (!options.model.empty()) {
        if (observer) {
            all.push_back({"learned_alone", false, true});
        }
        all.push_back({"learned", observer, true});
    }
    return all;
}

/// Results of one simulated run. `tracking`: nothing if the loop stopped by itself.
struct SimulatedRun {
    std::optional<TrackingRun> tracking;
    nlohmann::ordered_json loop;
};

SimulatedRun simulate_run(const LoopParts& parts, const LoopOptions& options,
                          const ComparedController& controller, FileSet& files,
                          std::vector<RecordedChanges>& changes) {
    LoopLimits limits = options.limits;
    if (!controller.observer) {
        limits.observer_bandwidth = {0};
    }
    ClosedLoop loop(parts.robot, parts.scenario, shown(options.scenario),
                    controller.learned ? &*parts.model : nullptr, parts.bus ? &*parts.bus : nullptr, limits);
    const std::string& name = controller.name;
    LoopRecording recording = make_recording(parts, options);
    Tracking tracking(options.window_s, 1 / parts.scenario.controller.rate_hz);
    LoopPeaks peaks;
    Progress progress("simulating " + name, static_cast<std::size_t>(options.duration_s * 1000));
    loop.run_to(options.duration_s, [&](const ClosedLoopInstant& instant) {
        tracking.add(instant.time_s, instant.error, loop.loop().feed_forward().learned_share());
        peaks.add(instant.command, loop.plant().truth().velocity);
        recording.add(instant.measured);
        progress.update(static_cast<std::size_t>(instant.time_s * 1000));
    });
    add_recording(options, name, recording, files);
    std::cout << name << ' ';
    print_loop(std::cout, loop.loop());
    print_reactions(std::cout, loop.reactions());
    print_peaks(std::cout, peaks);
    show_changes(name, loop.loop(), changes);
    if (controller.name == compared_controllers(options).back().name) {
        save_learned(options, loop.loop(), files);
        save_calibrated(options, parts, loop.loop(), files);
    }
    SimulatedRun result{std::nullopt, loop_json(name, loop.loop(), peaks)};
    result.loop["reactions"] = reactions_json(loop.reactions());
    if (loop.loop().state() == LoopState::running) {
        result.tracking = TrackingRun{name, tracking.windows()};
    }
    return result;
}

int simulate(const LoopOptions& options) {
    const JsonOutput output(options.json);
    const LoopParts parts = read_parts(options);
    std::vector<TrackingRun> runs;
    nlohmann::ordered_json loops = nlohmann::ordered_json::array();
    bool stopped = false;
    FileSet files;
    std::vector<RecordedChanges> changes;
    for (const ComparedController& controller : compared_controllers(options)) {
        SimulatedRun run = simulate_run(parts, options, controller, files, changes);
        stopped = stopped || !run.tracking;
        if (run.tracking) {
            runs.push_back(*run.tracking);
        }
        loops.push_back(std::move(run.loop));
    }
    nlohmann::ordered_json figures = tracking_json(runs, stopped);
    figures["loops"] = std::move(loops);
    add_changes(options, changes, files);
    if (!runs.empty()) {
        show_tracking(parts, options, runs, files);
    }
    files.commit();
    output.print(figures);
    return stopped ? 1 : 0;
}

int run_on_bus(const LoopOptions& options) {
    const JsonOutput output(options.json);
    const LoopParts parts = read_parts(options);
    const double period_s = 1 / parts.scenario.controller.rate_hz;
    LoopPort port(*parts.bus, period_s);
    const auto loop =
        make_control_loop(parts.robot, parts.scenario, shown(options.scenario),
                          parts.model ? &*parts.model : nullptr, port.delay_ticks(), options.limits);
    LoopLog log{Tracking(options.window_s, period_s), make_recording(parts, options)};
    const PaceOutcome pace = run_loop(
        *loop, port,
        {options.interface, period_s, options.duration_s, stop_on_signals(), &toggle_on_signal()}, log);
    print_loop(std::cout, *loop);
    print_peaks(std::cout, log.peaks);
    print_port(std::cout, port.counters());
    print_pace(std::cout, pace);
    const std::string name = compared_controllers(options).back().name;
    FileSet files;
    save_learned(options, *loop, files);
    save_calibrated(options, parts, *loop, files);
    add_recording(options, name, log.recording, files);
    std::vector<RecordedChanges> changes;
    show_changes(name, *loop, changes);
    add_changes(options, changes, files);
    const std::vector<TrackingRun> runs{{name, log.tracking.windows()}};
    const bool stopped = loop->cause() != StopCause::requested;
    nlohmann::ordered_json figures = tracking_json(runs, stopped);
    figures["loops"] = nlohmann::ordered_json::array({loop_json(name, *loop, log.peaks)});
    figures["bus"] = port_json(port.counters());
    figures["pace"] = pace_json(pace);
    show_tracking(parts, options, runs, files);
    files.commit();
    output.print(figures);
    return stopped ? 1 : 0;
}

void check_usage(const LoopOptions& options) {
    const bool model = !options.model.empty();
    refuse(!model && !options.on_finding.empty(), "loop: --on-finding: expected --model, found none");
    refuse(!model && !options.on_contact.empty(), "loop: --on-contact: expected --model, found none");
    refuse(options.from_prior && !options.on_contact.empty(),
           "loop: --on-contact: expected the trained start, to which the limits of contacts belong, found "
           "--from-prior");
    refuse(!model && (options.from_prior || !options.limits.learned_limit.empty()),
           "loop: --from-prior and --learned-limit: expected --model, found none");
    refuse(options.simulate && options.limits.mode == StopMode::limp,
           "loop: --stop limp: expected --can, found --simulate, which ends at the stop");
    refuse(options.on_contact.empty() && options.limits.contact_rate_per_hour,
           "loop: --contact-rate: expected --on-contact, found none");
    refuse(options.on_contact.empty() && options.limits.contact_calibration_s > 0,
           "loop: --contact-calibration: expected --on-contact, found none");
    refuse(!options.calibrated.empty() && !(options.limits.contact_calibration_s > 0),
           "loop: --save-calibrated: expected --contact-calibration, found none");
    refuse(options.duration_s > 0 && options.limits.contact_calibration_s >= options.duration_s,
           "loop: --contact-calibration: expected less than --duration, found no less");
    refuse(!model && !(options.restored.empty() && options.saved.empty()),
           "loop: --restore and --save: expected --model, found none");
    refuse(options.simulate && !options.interface.empty(),
           "loop: expected one of --simulate and --can, found both");
    refuse(!options.simulate && options.interface.empty(),
           "loop: expected one of --simulate and --can, found none");
    refuse(options.simulate && !(options.duration_s > 0), "loop --simulate: expected --duration, found none");
    refuse(!options.simulate && options.bus.empty(), "loop --can: expected --bus, found none");
}

} // namespace

int run_loop_command(LoopOptions& options) {
    options.limits.actions = FindingActions(options.on_finding, "--on-finding");
    if (!options.on_contact.empty()) {
        options.limits.on_contact = contact_action(options.on_contact, "--on-contact");
    }
    check_usage(options);
    return options.simulate ? simulate(options) : run_on_bus(options);
}

} // namespace dfdyn::tools
