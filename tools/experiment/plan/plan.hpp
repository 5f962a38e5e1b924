// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// One way to model the arm: a row of the table model × input × tuning, or a combination of such. The values
/// here are the defaults.
struct Case {
    std::string name;                 ///< unique in its plan, e.g. NP-ML-DFR
    std::vector<std::string> members; ///< the cases that it combines; then nothing else here counts
    std::string suffix;               ///< the end of the name that the plan chose; empty: one of the paper's
    std::string model = "NP";         ///< P, NP, SP, SP2, SPK
    InputKind input = InputKind::DFR;
    std::string hyper = "ML";           ///< ML, CV
    std::string physics_input = "same"; ///< what the physics sees: the features' input, or filters of its own
    std::vector<std::string> effects;   ///< of the physics, beside the rigid body
    std::string prior = "scaled";       ///< of the physics' parameters: scaled, unit, diagonal
    int lags = 10;                      ///< M
    int rows_per_joint = 3;             ///< k of DFR
    int feature_count = 250;            ///< d
    bool orthogonal = true;             ///< orthogonal random features
    bool relevance = true;              ///< STD: velocity and acceleration have gains; false: as in the paper
    bool centred = true;                ///< NP: outputs less their mean; false: as in the paper
    double forgetting_factor = 1;
    int likelihood_rows = 1000; ///< samples in the exact kernel, at most
    int starts = 6;             ///< local searches
};

/// Outputs whose errors are averaged, as the three forces of a wrench are.
struct OutputGroup {
    std::string name;
    std::vector<std::string> outputs;
};

/// The robot of the models with physics; `urdf` empty: the plan has none.
struct RobotChoice {
    std::filesystem::path urdf;
    std::string base, tip, ft_joint;            ///< empty: found by itself
    std::array<double, 3> gravity{0, 0, -9.81}; ///< m/s², in the frame of the URDF's root link
    double sign_velocity = 0.05;                ///< of Coulomb friction's tanh(qd / v), rad/s
    std::vector<double> torque_constants;       ///< N·m/A of each joint, for currents; empty: estimated
};

/// A recording cut into subsets of `rows` rows each, `count` of them from row `first` on.
struct TestLog {
    std::filesystem::path log;
    std::size_t first = 0, rows = 0, count = 1;
};

enum class Phase { transient, steady };

/// What ε divides the squared error by: the squared output over the same horizon, as the paper does; or the
/// output's variance over all subsets, which no standstill at zero inflates.
enum class ErrorScale { horizon, variance };

/// The statement "`better` errs less than `worse`, by a share `gain` at least". A negative gain tolerates
/// that `better` is that much worse.
struct Comparison {
    std::string better, worse, group;
    Phase phase = Phase::steady;
    double gain = 0;
};

/// A statement in words and the comparisons that it stands or falls with.
struct ExpectedFinding {
    std::string name, statement;
    std::string if_not; ///< shown with the verdict unless it is reproduced; may be empty
    std::vector<Comparison> comparisons;
};

/// Cases that one picture compares.
struct Figure {
    std::string title;
    std::vector<std::string> cases;
};

/// What `dfdyn evaluate` does; see docs/guide/evaluation.md for its file.
struct Plan {
    std::string name; ///< begins the names of the pictures: letters, digits, '-' and '_'
    std::string title;
    RobotChoice robot;
    OutputKind outputs = OutputKind::wrench;
    std::filesystem::path training_log;
    std::size_t start_rows = 1000;            ///< first rows of training_log: hyperparameters and start
    std::optional<std::size_t> training_rows; ///< of training_log, those used; none: all
    std::vector<TestLog> tests;
    std::size_t horizon = 25;   ///< T
    double steady_after_s = 30; ///< since the subset's start
    ErrorScale error_scale = ErrorScale::horizon;
    std::vector<std::uint64_t> seeds; ///< of the draws of random features
    std::vector<OutputGroup> groups;
    std::vector<Case> cases;
    std::vector<Figure> figures;
    std::vector<Comparison> comparisons;
    std::vector<ExpectedFinding> findings;
};

std::string to_string(Phase phase);
std::string to_string(ErrorScale scale);

/// Reads a plan, with the fields that it lacks from the plan that it names as "like"; relative paths are
/// those from the plan's folder. Throws InputError with the path of the field for anything missing, unknown
/// or out of its range, for a name that is not there, and for one that is there twice.
Plan read_plan(const std::filesystem::path& path);

/// The case of that name, which must be there.
const Case& case_named(const Plan& plan, const std::string& name);

/// The same cases with one draw, few features, rows and starts: shows in seconds that all of them run, not
/// how good they are.
Plan quick_plan(Plan plan);

} // namespace dfdyn::tools
