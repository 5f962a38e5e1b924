// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/temporary_directory.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/simulation/simulation_csv.hpp"
#include "tools/training/model_training.hpp"
#include "tools/training/training_options.hpp"

#include <fstream>
#include <string>
#include <vector>

namespace dfdyn::tests {

inline tools::Robot small_arm() {
    tools::ReadRobotOptions options;
    options.tip = "tool";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf", options);
}

/// Readings of the small arm's sensors over a few seconds of motion.
class SimulatedRecording {
  public:
    explicit SimulatedRecording(const tools::Robot& robot) {
        const tools::Scenario scenario =
            tools::read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json", robot);
        std::ofstream file(path());
        tools::SimulatedRecordingCsv csv(file, scenario, robot.joints.size());
        tools::Simulation simulation(robot, scenario);
        for (std::size_t row = 0; row < scenario.recording.samples; ++row) {
            csv.write(simulation.next());
        }
    }

    tools::Recording rows(tools::OutputKind outputs, std::size_t first, std::size_t last) const {
        tools::ReadOptions options;
        options.outputs = outputs;
        options.velocity = options.acceleration = true;
        options.rows = {first, last};
        return tools::read_recording(path(), options);
    }

  private:
    std::filesystem::path path() const { return directory_.path() / "run.csv"; }

    TemporaryDirectory directory_;
};

struct Combination {
    const tools::Structure* model;
    tools::InputKind input;
    tools::DerivativeSource derivatives;
    tools::HyperMethod hyper;
};

inline std::string name(const Combination& one) {
    const bool measured =
        one.input == tools::InputKind::STD && one.derivatives == tools::DerivativeSource::measured;
    return std::string(one.model->name) + " " + tools::input_description(one.input).name +
           (measured ? " (measured)" : "") + (one.hyper == tools::HyperMethod::ML ? " ML" : " CV");
}

/// All combinations. CV exists for NP, P and SP2 with STD, DF and DFSR; STD has measured or estimated
/// derivatives.
inline std::vector<Combination> table() {
    std::vector<Combination> rows;
    for (const tools::Structure* const model : tools::all_structures()) {
        for (const tools::InputKind input :
             {tools::InputKind::STD, tools::InputKind::DF, tools::InputKind::DFW, tools::InputKind::DFR,
              tools::InputKind::DFSR}) {
            const bool cv = model != &tools::structures::SP && model != &tools::structures::SPK &&
                            input != tools::InputKind::DFW && input != tools::InputKind::DFR;
            for (const tools::HyperMethod hyper : {tools::HyperMethod::ML, tools::HyperMethod::CV}) {
                if (hyper == tools::HyperMethod::CV && !cv) {
                    continue;
                }
                rows.push_back({model, input, tools::DerivativeSource::estimated, hyper});
                if (input == tools::InputKind::STD) {
                    rows.push_back({model, input, tools::DerivativeSource::measured, hyper});
                }
            }
        }
    }
    return rows;
}

inline tools::ModelTraining training_of(const Combination& one, tools::OutputKind outputs,
                                        const tools::Robot& robot) {
    tools::ModelTraining training;
    training.derivatives = one.derivatives;
    tools::TrainingOptions& options = training.options;
    options.model = one.model;
    options.input = one.input;
    options.hyper = one.hyper;
    options.lags = 6;
    options.feature_count = 15;
    options.likelihood_rows = 80;
    options.starts = 1;
    options.evaluations_per_start = 30;
    options.refinement_evaluations = 0;
    options.threads = 1;
    options.shrinkage = false; // compared with the prior and the deviations of the paper
    training.physics = tools::RobotPhysics{robot, {"ft_bias"}, 0.1, {}};
    if (outputs == tools::OutputKind::joint_torque) {
        training.physics->effects = {"viscous_friction", "coulomb_friction", "torque_offset"};
    }
    return training;
}

} // namespace dfdyn::tests
