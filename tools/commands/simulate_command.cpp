// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_set.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/log/bus_traffic.hpp"
#include "tools/can/log/frame_recorder.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/simulation/simulation_csv.hpp"

#include <cmath>
#include <memory>

namespace dfdyn::tools {

namespace {

struct SimulateOptions {
    std::filesystem::path robot;
    std::filesystem::path scenario;
    std::filesystem::path recording;
    std::filesystem::path truth;
    std::filesystem::path candump;
    std::filesystem::path bus;
    std::optional<std::uint64_t> seed;
};

/// Writes the frames of a bus' devices as a log.
class CandumpOutput {
  public:
    CandumpOutput(const SimulateOptions& options, const Robot& robot, const Scenario& scenario,
                  std::ostream& out)
        : description_(read_bus_description(options.bus)), torque_sensor_(scenario.torque_sensor),
          writer_(out, "can0"), traffic_(description_, {.seed = scenario.seed},
                                         [this](const hal::Frame& frame) { writer_.write(frame); }) {
        const bool measured = description_.outputs == OutputKind::wrench ? scenario.force_torque.has_value()
                              : description_.outputs == OutputKind::motor_current
                                  ? scenario.torque_sensor.torque_constant.has_value()
                                  : true;
        if (description_.joint_count != static_cast<int>(robot.joints.size()) || !measured) {
            throw InputError(description_.source +
                             ": expected the joints of the robot, and outputs that the scenario measures, "
                             "found others");
        }
    }

    void write(const SimulatedSample& sample) {
        traffic_.add(std::llround(1e9 * sample.time_s), span_of(sample.position), span_of(output(sample)));
    }

    void finish() { traffic_.finish(); }

  private:
    static std::span<const double> span_of(const auto& values) {
        return {values.data(), static_cast<std::size_t>(values.size())};
    }

    const Eigen::VectorXd& output(const SimulatedSample& sample) {
        output_ = description_.outputs == OutputKind::wrench ? Eigen::VectorXd(sample.wrench)
                  : description_.outputs == OutputKind::motor_current
                      ? Eigen::VectorXd(torque_sensor_.current(sample.torque))
                      : Eigen::VectorXd(sample.torque);
        return output_;
    }

    BusDescription description_;
    TorqueSensorModel torque_sensor_;
    FrameWriter writer_;
    BusTraffic traffic_;
    Eigen::VectorXd output_;
};

/// The requested files: recording, true quantities and frames.
class Outputs {
  public:
    Outputs(const SimulateOptions& options, const Scenario& scenario, const Robot& robot)
        : recording_(files_.add(options.recording), scenario, robot.joints.size()) {
        if (!options.truth.empty()) {
            truth_.emplace(files_.add(options.truth), scenario.force_torque.has_value(), robot.joints.size());
        }
        if (!options.candump.empty()) {
            candump_.emplace(options, robot, scenario, files_.add(options.candump));
        }
    }

    void write(const SimulatedSample& sample) {
        recording_.write(sample);
        if (truth_) {
            truth_->write(sample.truth);
        }
        if (candump_) {
            candump_->write(sample);
        }
    }

    void commit() {
        if (candump_) {
            candump_->finish();
        }
        files_.commit();
    }

  private:
    FileSet files_;
    SimulatedRecordingCsv recording_;
    std::optional<SimulatedTruthCsv> truth_;
    std::optional<CandumpOutput> candump_;
};

int run(const SimulateOptions& options) {
    check_distinct({options.recording, options.truth, options.candump},
                   {options.robot, options.scenario, options.bus});
    if (options.candump.empty() != options.bus.empty()) {
        throw InputError("expected --candump and --bus together, found one of them");
    }
    const Robot robot = read_scenario_robot(options.robot, options.scenario);
    Scenario scenario = read_scenario(options.scenario, robot);
    scenario.seed = options.seed.value_or(scenario.seed);
    Simulation simulation(robot, scenario);
    Outputs outputs(options, scenario, robot);
    Progress progress("simulating", scenario.recording.samples);
    for (std::size_t done = 0; done < scenario.recording.samples; ++done) {
        outputs.write(simulation.next());
        progress.update(done);
    }
    outputs.commit();
    return 0;
}

} // namespace

void add_simulate_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<SimulateOptions>();
    CLI::App* command = app.add_subcommand(
        "simulate", "Simulates an arm, its actuators and its sensors; writes the readings of the sensors");
    command->add_option("--robot", options->robot, "The arm")->required()->type_name("R.urdf");
    command
        ->add_option("--scenario", options->scenario,
                     "Chain, task, controller, friction, sensors, recording: docs/reference/scenario.md")
        ->required()
        ->type_name("S.json");
    command->add_option("-o,--output", options->recording, "The recording")->required()->type_name("L.csv");
    command
        ->add_option("--truth", options->truth,
                     "The same rows without sensors: true motion, torques, friction, wrench, tip")
        ->type_name("T.csv");
    command
        ->add_option("--candump", options->candump,
                     "The frames of the devices in --bus, in the format of candump -L")
        ->type_name("L.log");
    command->add_option("--bus", options->bus, "The devices: docs/reference/can.md")->type_name("B.json");
    command->add_option("--seed", options->seed, "Seed to use instead of the scenario's")
        ->check(seed_number())
        ->type_name("N");
    command->footer("Example:\n  dfdyn simulate --robot arm.urdf --scenario circles.json -o run.csv\n"
                    "The same robot, scenario and seed give the same bytes.\n"
                    "Exit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
