// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/options.hpp"
#include "tools/commands/robot_options.hpp"
#include "tools/commands/stop_signal.hpp"
#include "tools/common/atomic_file.hpp"
#include "tools/common/error.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/text.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/real_time_run.hpp"
#include "tools/control/tracking_report.hpp"
#include "tools/model/model_file.hpp"
#include "tools/recording/csv_writer.hpp"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>

namespace dfdyn::tools {

namespace {

struct LoopOptions {
    std::filesystem::path robot, scenario, model, bus, folder;
    std::string interface;
    bool simulate = false;
    bool from_prior = false;
    double duration_s = 0;
};

struct LoopParts {
    Robot robot;
    Scenario scenario;
    std::optional<LoopModel> model;
    std::optional<BusDescription> bus;
};

LoopParts read_parts(const LoopOptions& options) {
    LoopParts parts{read_scenario_robot(options.robot, options.scenario), {}, {}, {}};
    parts.scenario = read_scenario(options.scenario, parts.robot);
    if (!options.model.empty()) {
        parts.model = LoopModel{read_model(options.model), shown(options.model), options.from_prior};
    }
    if (!options.bus.empty()) {
        parts.bus = read_bus_description(options.bus);
        check_bus(*parts.bus, parts.robot, parts.scenario);
    }
    return parts;
}

/// What `dfdyn train` reads: the positions and torques of each knot.
class LoopRecording {
  public:
    LoopRecording(const std::filesystem::path& path, std::size_t joints, int every)
        : file_(path), csv_(file_.stream(), columns(joints)), every_(every) {}

    void add(const ClosedLoopInstant& instant) {
        if (tick_++ % every_ == 0 && instant.position.size() > 0 && instant.torque.size() > 0) {
            csv_.field(instant.time_s).fields(values(instant.position)).fields(values(instant.torque));
            csv_.end_row();
        }
    }
    void commit() { file_.commit(); }

  private:
    static std::vector<std::string> columns(std::size_t joints) {
        std::vector<std::string> names{"t"};
        for (const char* const prefix : {"q", "tau"}) {
            std::ranges::copy(joint_names(prefix, joints), std::back_inserter(names));
        }
        return names;
    }
    static std::span<const double> values(const JointVector& vector) {
        return {vector.data(), static_cast<std::size_t>(vector.size())};
    }

    AtomicFile file_;
    CsvWriter csv_;
    int every_;
    long tick_ = 0;
};

void print_learning(std::ostream& out, const FeedForward& feed_forward) {
    if (const LearnedFeedForward* const learned = feed_forward.learned()) {
        const LearningCounters& counters = learned->counters();
        out << "learning: " << counters.samples << " samples, " << counters.learned << " learned, "
            << counters.faults << " refused";
        if (counters.faults > 0) {
            out << " (last: " << name(counters.last_fault) << ')';
        }
        out << "; " << learned->cost() << " multiply-adds per sample\n";
    }
}

void print_loop(std::ostream& out, const ControlLoop& loop) {
    const LoopCounters& counters = loop.counters();
    out << "loop: " << counters.ticks << " ticks, " << counters.running << " followed the reference, "
        << counters.coasted << " without position, " << counters.limited << " at a torque limit; "
        << name(loop.state()) << " (" << name(loop.cause()) << ")\n";
    print_learning(out, loop.feed_forward());
}

TrackingRun simulate_run(const LoopParts& parts, const LoopOptions& options, bool learned) {
    ClosedLoop loop(parts.robot, parts.scenario, shown(options.scenario), learned ? &*parts.model : nullptr,
                    parts.bus ? &*parts.bus : nullptr);
    const std::string name = learned ? "learned" : "nominal";
    constexpr int recorded_every = 8;
    std::optional<LoopRecording> recording;
    if (!options.folder.empty()) {
        recording.emplace(options.folder / (name + ".csv"), parts.robot.joints.size(), recorded_every);
    }
    Tracking tracking;
    Progress progress("simulating " + name, static_cast<std::size_t>(options.duration_s * 1000));
    loop.run_to(options.duration_s, [&](const ClosedLoopInstant& instant) {
        tracking.add(instant.time_s, instant.error, loop.loop().feed_forward().learned_share());
        if (recording) {
            recording->add(instant);
        }
        progress.update(static_cast<std::size_t>(instant.time_s * 1000));
    });
    if (recording) {
        recording->commit();
    }
    std::cout << name << ' ';
    print_loop(std::cout, loop.loop());
    return {name, tracking.windows()};
}

int simulate(const LoopOptions& options) {
    const LoopParts parts = read_parts(options);
    if (!options.folder.empty()) {
        make_folder(options.folder);
    }
    std::vector<TrackingRun> runs{simulate_run(parts, options, false)};
    if (parts.model) {
        runs.push_back(simulate_run(parts, options, true));
    }
    print_tracking(std::cout, runs);
    if (!options.folder.empty()) {
        write_tracking(options.folder, runs);
    }
    return 0;
}

int run_on_bus(const LoopOptions& options) {
    const LoopParts parts = read_parts(options);
    const double period_s = 1 / parts.scenario.controller.rate_hz;
    LoopPort port(*parts.bus, period_s);
    const auto loop = make_control_loop(parts.robot, parts.scenario, shown(options.scenario),
                                        parts.model ? &*parts.model : nullptr, port.delay_ticks());
    const PaceOutcome pace =
        run_loop(*loop, port, options.interface, period_s, options.duration_s, stop_on_signals());
    if (!pace.not_real_time.empty()) {
        std::cerr << "note: the timing is that of an ordinary program (" << pace.not_real_time << ")\n";
    }
    print_loop(std::cout, *loop);
    std::cout << "pace: " << pace.late << " deadlines missed, worst lateness " << pace.worst_lateness_us
              << " us; " << port.refused() << " command frames refused\n";
    return loop->cause() == StopCause::requested ? 0 : 1;
}

int run(const LoopOptions& options) {
    if (options.simulate == !options.interface.empty()) {
        throw InputError("loop: expected one of --simulate and --can, found " +
                         std::string(options.simulate ? "both" : "none"));
    }
    if (options.simulate) {
        if (!(options.duration_s > 0)) {
            throw InputError("loop --simulate: expected --duration, found none");
        }
        return simulate(options);
    }
    if (options.bus.empty()) {
        throw InputError("loop --can: expected --bus, found none");
    }
    return run_on_bus(options);
}

} // namespace

void add_loop_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<LoopOptions>();
    CLI::App* command = app.add_subcommand(
        "loop", "Moves an arm: feedback, and feed-forward of a rigid body or a model that learns on");
    command->add_option("--robot", options->robot, "The arm, as its file knows it")
        ->required()
        ->type_name("R.urdf");
    command
        ->add_option("--scenario", options->scenario,
                     "Task, gains, limits; for --simulate also friction, payloads, sensors: docs/scenario.md")
        ->required()
        ->type_name("S.json");
    command->add_option("--model", options->model, "Of the joints' torques; none: the rigid body alone")
        ->type_name("M.json");
    command->add_flag("--from-prior", options->from_prior, "The model begins with nothing learned");
    command->add_option("--bus", options->bus, "Devices on the bus: docs/can.md")->type_name("bus.json");
    command->add_option("--can", options->interface, "The arm is here")->type_name("IFACE");
    command->add_flag("--simulate", options->simulate, "The arm is simulated, in simulated time");
    command->add_option("--duration", options->duration_s, "Seconds; with --can none: until Ctrl-C")
        ->check(CLI::PositiveNumber)
        ->type_name("S");
    command
        ->add_option("-o,--output", options->folder,
                     "With --simulate: tracking.csv, tracking.svg and a recording of each run")
        ->type_name("DIR");
    command->footer(
        "Examples:\n"
        "  dfdyn loop --simulate --robot arm.urdf --scenario s.json --model m.json --duration 90 -o out\n"
        "  dfdyn loop --robot arm.urdf --scenario s.json --model m.json --bus bus.json --can can0\n"
        "Exit status: 0 done, 1 the loop stopped by itself for safety, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
