// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/options.hpp"
#include "tools/commands/robot_options.hpp"
#include "tools/common/atomic_file.hpp"
#include "tools/common/progress.hpp"
#include "tools/simulation/simulation_csv.hpp"

#include <memory>

namespace dfdyn::tools {

namespace {

struct SimulateOptions {
    std::filesystem::path robot;
    std::filesystem::path scenario;
    std::filesystem::path recording;
    std::filesystem::path truth;
    std::optional<std::uint64_t> seed;
};

Robot read_chain(const SimulateOptions& options) {
    const ScenarioChain chain = read_scenario_chain(options.scenario);
    RobotOptions reading;
    reading.urdf = options.robot;
    reading.tip = chain.tip;
    reading.base = chain.base;
    reading.ft_joint = chain.ft_joint;
    reading.wrench_direction = chain.wrench_direction;
    reading.gravity = chain.gravity;
    // whether a sensor is needed, the scenario tells
    Robot robot = reading.read(OutputKind::joint_torque);
    robot.tip_placement.translate(chain.tip_point);
    return robot;
}

/// A recording, and the truth where asked for, that appear whole or not at all.
class Outputs {
  public:
    Outputs(const SimulateOptions& options, const Scenario& scenario, std::size_t joint_count)
        : recording_file_(options.recording), recording_(recording_file_.stream(), scenario, joint_count) {
        if (!options.truth.empty()) {
            truth_file_.emplace(options.truth);
            truth_.emplace(truth_file_->stream(), scenario.force_torque.has_value(), joint_count);
        }
    }

    void write(const SimulatedSample& sample) {
        recording_.write(sample);
        if (truth_) {
            truth_->write(sample.truth);
        }
    }

    void commit() {
        if (truth_file_) {
            truth_file_->commit();
        }
        recording_file_.commit();
    }

  private:
    AtomicFile recording_file_;
    SimulatedRecordingCsv recording_;
    std::optional<AtomicFile> truth_file_;
    std::optional<SimulatedTruthCsv> truth_;
};

int run(const SimulateOptions& options) {
    check_distinct({options.recording, options.truth}, {options.robot, options.scenario});
    const Robot robot = read_chain(options);
    Scenario scenario = read_scenario(options.scenario, robot);
    scenario.seed = options.seed.value_or(scenario.seed);
    Simulation simulation(robot, scenario);
    Outputs outputs(options, scenario, robot.joints.size());
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
        "simulate",
        "Simulates an arm, its actuators and its sensors; writes what the sensors would have shown");
    command->add_option("--robot", options->robot, "The arm")->required()->type_name("R.urdf");
    command
        ->add_option("--scenario", options->scenario,
                     "Chain, task, controller, friction, sensors, recording: docs/scenario.md")
        ->required()
        ->type_name("S.json");
    command->add_option("-o,--output", options->recording, "The recording")->required()->type_name("L.csv");
    command
        ->add_option("--truth", options->truth,
                     "The same rows without sensors: true motion, torques, friction, wrench, tip")
        ->type_name("T.csv");
    command->add_option("--seed", options->seed, "Instead of the scenario's own")->type_name("N");
    command->footer("Example:\n  dfdyn simulate --robot arm.urdf --scenario circles.json -o run.csv\n"
                    "The same robot, scenario and seed give the same bytes.\n"
                    "Exit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
