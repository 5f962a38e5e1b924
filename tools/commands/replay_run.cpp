// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/replay_run.hpp"

#include "tools/base/bag/bag.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/system/file_set.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/build_flags.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/stop_signal.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/run_time/frozen_estimator.hpp"
#include "tools/replay/opponents/rigid_body.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_csv.hpp"
#include "tools/replay/replay_report.hpp"
#include "tools/replay/replay_summary.hpp"
#include "tools/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

/// Number of ticks kept with --can for the summary and the report: a bound for replays of unlimited duration.
constexpr std::size_t kept_live_ticks = 32'768;

void check_usage(const ReplayOptions& options) {
    const bool bus = !options.bus.empty();
    if (options.recordings.logs.empty() != options.live()) {
        throw InputError("replay: expected one of --log and --can, found " +
                         std::string(options.live() ? "both" : "none"));
    }
    refuse(options.live() && !bus, "--can: expected --bus with the devices on it, found none");
    refuse(bus && options.recordings.has_choice(),
           "--rows, --skip-bad-rows, --columns, --units, --topic: expected a CSV recording, found --bus");
    refuse(!bus && !options.log_interface.empty(), "--from: expected --bus, found a CSV recording");
    refuse(options.live() && !options.log_interface.empty(), "--from: expected --log, found --can");
    refuse(!options.live() && (options.can.duration_s > 0 || !options.can.record.empty()),
           "--duration, --record: expected --can, found a recording");
    refuse(!options.monitor.wanted() && options.monitor.has_choice(),
           "--false-alarms, --robot: expected --monitor or --changes, found neither");
    refuse(!options.contacts.wanted() && options.contacts.rate_per_hour,
           "--contact-rate: expected --contacts or --contact-list, found neither");
}

/// The estimator of the replay, with its contact detector and its monitor if there are any.
struct Replaying {
    std::unique_ptr<RuntimeEstimator> estimator;
    MonitoredEstimator* monitor = nullptr;
    std::vector<RecordedChanges> changes;
    ContactEstimator* detector = nullptr;
    std::vector<RecordedContacts> contacts;

    /// Moves the changes and contacts of the last replayed recording here.
    void collect(const ReplayedRecording& replayed) {
        const std::string recording = std::filesystem::path(replayed.source).filename().string();
        if (monitor != nullptr) {
            changes.push_back({recording, replayed.clock_origin_s, monitor->take_changes()});
        }
        if (detector != nullptr) {
            contacts.push_back({recording, replayed.clock_origin_s, detector->take_contacts()});
        }
    }
};

Replaying make_replaying(const ReplayOptions& options, std::span<const TrainedModel> models) {
    Replaying replaying{make_estimator(models, options.from_prior), nullptr, {}, nullptr, {}};
    if (options.frozen) {
        replaying.estimator = frozen(std::move(replaying.estimator));
    }
    if (options.contacts.wanted()) {
        auto watched =
            with_contacts(std::move(replaying.estimator),
                          {options.contacts.limits(models.front(), shown(options.models.front()))});
        replaying.detector = watched.get();
        replaying.estimator = std::move(watched);
    }
    if (options.monitor.wanted()) {
        auto watched = monitored(std::move(replaying.estimator),
                                 options.monitor.setup(models, shown(options.models.front())));
        replaying.monitor = watched.get();
        replaying.estimator = std::move(watched);
    }
    return replaying;
}

/// Reads models, which must have the same joints, outputs and sample periods.
std::vector<TrainedModel> read_models(const std::vector<std::filesystem::path>& paths) {
    std::vector<TrainedModel> models;
    for (const std::filesystem::path& path : paths) {
        models.push_back(read_model(path));
        const TrainedModel& first = models.front();
        const TrainedModel& last = models.back();
        if (last.joints != first.joints || last.outputs.names != first.outputs.names) {
            throw InputError(shown(path) + ": expected joints and outputs as in " + shown(paths.front()) +
                             ", " + std::to_string(first.joints) + " and " + listed(first.outputs.names) +
                             ", found " + std::to_string(last.joints) + " and " + listed(last.outputs.names));
        }
        if (std::abs(last.sample_period_s / first.sample_period_s - 1) > followed_deviation) {
            throw InputError(shown(path) + ": expected the sample period of " + shown(paths.front()) + ", " +
                             rounded_text(first.sample_period_s) + " s, found " +
                             rounded_text(last.sample_period_s) + " s");
        }
    }
    return models;
}

/// Reads the recordings as the model's training did, unless the options say otherwise.
std::vector<Recording> read_recordings(const ReplayOptions& options, std::span<const TrainedModel> models,
                                       ReadOptions columns) {
    const TrainingRecord& trained = models.front().training;
    columns.joint_names = trained.joint_names;
    RecordingOptions recordings = options.recordings;
    if (std::ranges::none_of(recordings.logs, is_bag)) { // a bag has columns and units of its own
        recordings.columns = recordings.columns.empty() ? trained.columns : recordings.columns;
        recordings.units = recordings.units.empty() ? trained.units : recordings.units;
    } else if (recordings.units.empty() && !trained.units.empty()) {
        print_note("note: a bag is read in rad, N m and A; the model's recordings had --units " +
                   trained.units);
    }
    std::vector<Recording> read = recordings.read(columns);
    for (const Recording& recording : read) {
        check_not_faster(recording, models.front().sample_period_s, shown(options.models.front()));
    }
    return read;
}

std::vector<ReplayedRecording> replay_all(const ReplayOptions& options, std::span<const TrainedModel> models,
                                          Replaying& replaying) {
    const auto joints = static_cast<std::size_t>(models.front().joints);
    ReadOptions columns;
    columns.joint_count = joints;
    columns.outputs = kind_of_outputs(models.front().outputs.names, joints);
    const PhysicsModel* const physics = rigid_body_of(models);
    columns.velocity = columns.acceleration =
        physics != nullptr || std::ranges::any_of(models, needs_derivatives);
    std::vector<ReplayedRecording> replayed;
    for (const Recording& recording : read_recordings(options, models, columns)) {
        Progress progress("replaying " + recording.source, recording.row_count());
        replayed.push_back(replay(*replaying.estimator, models, recording, options.chosen_horizon(),
                                  [&progress](std::size_t done) { progress.update(done); }));
        if (physics != nullptr) {
            for (const RigidBodyFit& fit : physics->rigid_body) {
                replayed.back().rigid_body.push_back(rigid_body_forecasts(fit, physics->chain, recording));
            }
        }
        replaying.collect(replayed.back());
    }
    return replayed;
}

std::vector<ReplayedBus> replay_bus(const ReplayOptions& options, std::span<const TrainedModel> models,
                                    Replaying& replaying) {
    const BusDescription description = read_bus_description(options.bus);
    RuntimeEstimator& estimator = *replaying.estimator;
    std::vector<ReplayedBus> replayed;
    if (options.live()) {
        ReplayCsvFile csv(options.csv, models.front());
        InterfaceOptions can = options.can;
        can.memory = {kept_live_ticks, options.csv.empty() ? nullptr : &csv};
        replayed.push_back(replay_interface(estimator, models, description, can, options.chosen_horizon(),
                                            stop_on_signals()));
        csv.flush();
        replaying.collect(replayed.back().replayed);
    }
    for (const std::filesystem::path& log : options.recordings.logs) {
        replayed.push_back(
            replay_log(estimator, models, description, log, options.log_interface, options.chosen_horizon()));
        replaying.collect(replayed.back().replayed);
    }
    return replayed;
}

void write_files(const ReplayOptions& options, const TrainedModel& model, const Replaying& replaying,
                 std::span<const ReplayedRecording> replayed, const ReplaySummary& summary) {
    FileSet files;
    if (!options.csv.empty() && !options.live()) {
        write_replay_csv(files.add(options.csv), model, replayed);
    }
    if (!options.report.empty()) {
        Report report = make_replay_report(model, replayed, summary);
        const std::filesystem::path full_data = options.full_data();
        report.full_data = full_data.filename().string();
        if (!full_data.empty() && full_data != options.csv) {
            if (has_thinned_page(report)) {
                write_replay_csv(files.add(full_data), model, replayed);
            } else {
                files.remove(full_data); // of an earlier run
            }
        }
        files.add(options.report, render_report(report));
    }
    if (replaying.monitor != nullptr) {
        options.monitor.add_file(replaying.changes, files);
    }
    if (replaying.detector != nullptr) {
        options.contacts.add_file(replaying.contacts, model.outputs.names, files);
    }
    files.commit();
}

void write_results(const ReplayOptions& options, std::span<const TrainedModel> models,
                   const Replaying& replaying, std::span<const ReplayedRecording> replayed,
                   const JsonOutput& output) {
    const ReplaySummary summary = summarise(models, *replaying.estimator, replayed, options.chosen_horizon());
    write_files(options, models.front(), replaying, replayed, summary);
    nlohmann::ordered_json json = replay_json(summary);
    if (replaying.monitor != nullptr) {
        json["monitor"] = options.monitor.json(replaying.changes);
    }
    if (replaying.detector != nullptr) {
        json["contacts"] = contacts_json(replaying.contacts, models.front().outputs.names);
    }
    output.print(json);
    print_summary(std::cout, summary);
    if (replaying.monitor != nullptr) {
        options.monitor.show(replaying.changes);
    }
    if (replaying.detector != nullptr) {
        options.contacts.show(replaying.contacts, models.front().outputs.names);
    }
}

bool predicted(const ReplayedRecording& replayed) { return replayed.totals.predicted > 0; }

/// Returns what was expected and found where `reason` is the most frequent one; empty if nothing is known.
std::string reason_detail(const ReplayedRecording& replayed, std::string_view reason, double period_s) {
    if (reason == name(Reason::position_out_of_range) && !replayed.beyond_limit.empty()) {
        return ": " + replayed.beyond_limit;
    }
    std::vector<double> steps_s;
    for (std::size_t tick = 1; tick < replayed.time_s.size(); ++tick) {
        steps_s.push_back(replayed.time_s[tick] - replayed.time_s[tick - 1]);
    }
    if (reason != name(Reason::gap) || steps_s.empty()) {
        return "";
    }
    return ": expected " + rounded_text(period_s) + " s between rows, found " +
           rounded_text(median(std::move(steps_s))) + " s";
}

/// Prints on stderr the most frequent reason why a recording had no prediction. `period_s`: of the model.
void explain_no_prediction(const ReplayedRecording& replayed, double period_s) {
    const auto& counts = replayed.totals.reasons;
    std::cerr << "dfdyn: " << shown(replayed.source) << ": nothing was predicted: ";
    if (counts.empty()) {
        std::cerr << "it has no ticks\n";
        return;
    }
    const auto most = std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; });
    std::cerr << most->second << " of " << replayed.totals.ticks << " ticks " << most->first
              << reason_detail(replayed, most->first, period_s)
              << "; check that units, sample period and columns are those of the model's training\n";
}

/// Exit status. A bus without a prediction is a failure; CSV recordings are a failure if none had a
/// prediction.
int exit_status(std::span<const ReplayedRecording> replayed, double period_s, bool bus) {
    const auto count = std::ranges::count_if(replayed, predicted);
    const bool done = bus ? count == std::ssize(replayed) : count > 0;
    for (const ReplayedRecording& one : replayed) {
        if (!done && !predicted(one)) {
            explain_no_prediction(one, period_s);
        }
    }
    return done ? 0 : 1;
}

} // namespace

int run_replay_command(const ReplayOptions& options) {
    check_usage(options);
    const JsonOutput output(options.json);
    std::vector<std::filesystem::path> inputs = options.recordings.with(options.models);
    inputs.insert(inputs.end(), {options.bus, options.monitor.robot.urdf});
    std::vector<std::filesystem::path> outputs{options.csv, options.report, options.can.record,
                                               options.monitor.file, options.contacts.file};
    check_outputs(outputs, inputs);
    if (options.full_data() != options.csv) { // is written only if the page is thinned
        outputs.push_back(options.full_data());
        check_distinct(outputs, std::move(inputs));
    }
    const std::vector<TrainedModel> models = read_models(options.models);
    Replaying replaying = make_replaying(options, models);
    if (options.bus.empty()) {
        const std::vector<ReplayedRecording> replayed = replay_all(options, models, replaying);
        write_results(options, models, replaying, replayed, output);
        return exit_status(replayed, models.front().sample_period_s, false);
    }
    std::vector<ReplayedBus> buses = replay_bus(options, models, replaying);
    std::vector<ReplayedRecording> replayed;
    for (ReplayedBus& one : buses) {
        replayed.push_back(std::move(one.replayed));
    }
    write_results(options, models, replaying, replayed, output);
    for (const ReplayedBus& one : buses) {
        print_bus(std::cout, one.bus);
    }
    return exit_status(replayed, models.front().sample_period_s, true);
}

} // namespace dfdyn::tools
