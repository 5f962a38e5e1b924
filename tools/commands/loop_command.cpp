// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/loop_run.hpp"
#include "tools/commands/options/contact_options.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <memory>

namespace dfdyn::tools {

namespace {

/// Adds the options of the learned model and its initial state.
void add_model(CLI::App& command, LoopOptions& options) {
    command
        .add_option("--model", options.model,
                    "Learned model of the joints' torques; default: the rigid body alone")
        ->type_name("M.json");
    command.add_flag("--from-prior", options.from_prior,
                     "Start with nothing learned: keep the hyperparameters, drop the trained start");
    command
        .add_option("--restore", options.restored,
                    "Continues from the learned state that --save wrote in an earlier run of the model")
        ->excludes("--from-prior")
        ->type_name("FILE");
    command
        .add_option("--save", options.saved,
                    "Writes the learned state at the end, except after a stop by the loop itself; an earlier "
                    "file stays")
        ->type_name("FILE");
    command
        .add_option("--on-finding", options.on_finding,
                    "What to do when the learner's monitor names a change, as CAUSE=ACTION,...: report (the "
                    "default), relearn, compensate (bias_moved) or stop; causes: docs/guide/loop.md")
        ->delimiter(',')
        ->type_name("CAUSE=ACTION");
    command
        .add_option(
            "--on-contact", options.on_contact,
            "What to do when something touches the arm: stop (the safe stop), hold (stops on the path and "
            "stays there: gravity torque and feedback) or yield (gravity torque alone; holds after the "
            "contact where the arm is then). The motion does not continue. Without it contacts are not "
            "detected. Not a safety function: docs/guide/contacts.md")
        ->type_name("stop|hold|yield");
    add_contact_rate(command, options.limits.contact_rate_per_hour, "With --on-contact");
    command
        .add_option("--contact-calibration", options.limits.contact_calibration_s,
                    "With --on-contact: measures the limits of contacts during the first S seconds with "
                    "motion. Nobody may touch the arm then: the limits are up to ten times the model's. "
                    "Default: the model's limits from the start")
        ->check(number_in(30, 3600))
        ->type_name("S");
    command
        .add_option("--save-calibrated", options.calibrated,
                    "With --contact-calibration: writes the model with the measured limits of contacts here, "
                    "for --model of the next start")
        ->type_name("M.json");
}

/// Adds the options of the loop's limits.
void add_limits(CLI::App& command, LoopLimits& limits) {
    command
        .add_option("--following-error", limits.following_error,
                    "Largest distance from the reference, rad (m); one value, or one per joint. Default: 0.8 "
                    "of the torque limit divided by the position gain, at most 0.5 rad or 0.1 m")
        ->delimiter(',')
        ->check(positive_number())
        ->type_name("E");
    command
        .add_option("--speed-limit", limits.speed,
                    "Largest speed, rad/s (m/s); one value, or one per joint. Default: the robot's limit, if "
                    "at most 100; otherwise none")
        ->delimiter(',')
        ->check(positive_number())
        ->type_name("V");
    command
        .add_option("--observer-bandwidth", limits.observer_bandwidth,
                    "Bandwidth of the disturbance observer, rad/s; one value, or one per joint; 0: no "
                    "observer. At most 0.2 times the loop's rate in Hz. Default: from docs/guide/loop.md, at "
                    "most 40")
        ->delimiter(',')
        ->check(number_from_zero())
        ->type_name("B");
    command
        .add_option("--learned-limit", limits.learned_limit,
                    "Largest learned torque that is added to the rigid body's, as a share of the torque "
                    "limit; one value, or one per joint. Learned are the model and, for SPK, its "
                    "physics alone with memories of 0.53 s and 8 s. 0: learned, but not used. Default: 0.5")
        ->delimiter(',')
        ->check(number_in(0.0, 1.0))
        ->type_name("F");
}

void add_stop(CLI::App& command, StopMode& stop) {
    command
        .add_option_function<std::string>(
            "--stop",
            [&stop](const std::string& mode) { stop = mode == "limp" ? StopMode::limp : StopMode::hold; },
            "After a stop: hold the arm until Ctrl-C or the end of --duration, or end 0.2 s after the brakes "
            "were requested. At the end the torque goes to zero within 0.1 s")
        ->check(one_of({"hold", "limp"}))
        ->default_str("hold")
        ->type_name("hold|limp");
}

/// Adds where the arm is: on a bus, or simulated.
void add_arm(CLI::App& command, LoopOptions& options) {
    command.add_option("--bus", options.bus, "Devices on the bus: docs/reference/can.md")
        ->type_name("bus.json");
    command.add_option("--can", options.interface, "Interface of the arm's bus")->type_name("IFACE");
    command.add_flag("--simulate", options.simulate, "The arm is simulated, in simulated time");
}

std::string examples_and_status() {
    return "Examples:\n"
           "  dfdyn loop --simulate --robot arm.urdf --scenario s.json --model m.json --duration 90 -o out\n"
           "  dfdyn loop --robot arm.urdf --scenario s.json --model m.json --bus bus.json --can can0\n"
           "With --can the signal SIGUSR1 removes the learned part from the torque, or adds it again, "
           "without a step.\n"
           "Kinds of faults of a scenario: " +
           fault_kind_names("and") +
           ".\n"
           "Exit status: 0 done, 1 the loop stopped by itself for safety, 2 bad usage or input.";
}

} // namespace

void add_loop_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<LoopOptions>();
    CLI::App* command = app.add_subcommand(
        "loop",
        "Moves an arm: feedback, and feed-forward of a rigid body or of a model that continues to learn");
    command->add_option("--robot", options->robot, "Description of the arm")->required()->type_name("R.urdf");
    command
        ->add_option("--scenario", options->scenario,
                     "Task, gains, limits; for --simulate also friction, payloads, sensors, faults: "
                     "docs/reference/scenario.md")
        ->required()
        ->type_name("S.json");
    add_model(*command, *options);
    add_arm(*command, *options);
    command->add_option("--duration", options->duration_s, "Seconds; default with --can: until Ctrl-C")
        ->check(positive_number())
        ->type_name("S");
    command
        ->add_option("--window", options->window_s,
                     "Time that each row of the tracking table covers, seconds")
        ->check(positive_number())
        ->capture_default_str()
        ->type_name("S");
    add_limits(*command, options->limits);
    add_stop(*command, options->limits.mode);
    command
        ->add_option(
            "-o,--output", options->folder,
            "Tracking error as tracking.csv, .svg and .html, a recording of each run (at most 10 minutes "
            "without --duration), and changes.json: changes of the arm that the learner's monitor found")
        ->type_name("DIR");
    add_json_option(*command, options->json);
    command->footer(examples_and_status());
    command->callback([options, &chosen] { chosen = [options] { return run_loop_command(*options); }; });
}

} // namespace dfdyn::tools
