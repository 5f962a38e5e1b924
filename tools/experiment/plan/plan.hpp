// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"
#include "tools/model/structure.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// One model of the arm: a combination of model, input and tuning, or a combination of several cases. The
/// values here are the defaults.
struct Case {
    std::string name;                 ///< unique in its plan, e.g. NP-ML-DFR
    std::vector<std::string> members; ///< cases to combine; the other fields are then unused
    std::string suffix;               ///< suffix of the name, from the plan; empty: a case of the paper
    std::string model = structures::NP.name;
    InputKind input = InputKind::DFR;
    std::string hyper = "ML";           ///< ML, CV
    std::string physics_input = "same"; ///< input of the physics: the features' input, or separate filters
    std::vector<std::string> effects;   ///< of the physics, in addition to the rigid body
    std::string prior = "scaled";       ///< of the physics' parameters: scaled, unit, diagonal
    int lags = 10;                      ///< M
    int rows_per_joint = 3;             ///< k of DFR
    int feature_count = 250;            ///< d
    bool orthogonal = true;             ///< orthogonal random features
    bool relevance = true;              ///< STD: velocity and acceleration have gains; false: as in the paper
    bool centred = true;                ///< NP: outputs minus their mean; false: as in the paper
    double forgetting_factor = 1;
    int likelihood_rows = 1000; ///< largest number of samples in the exact kernel
    int starts = 6;             ///< local searches
};

/// Outputs whose errors are averaged, such as the three forces of a wrench.
struct OutputGroup {
    std::string name;
    std::vector<std::string> outputs;
};

/// The robot for models with physics; empty `urdf`: the plan has none.
struct RobotChoice {
    std::filesystem::path urdf;
    std::string base, tip, ft_joint;            ///< empty: determined automatically
    std::array<double, 3> gravity{0, 0, -9.81}; ///< m/s², in the frame of the URDF's root link
    double sign_velocity = 0.05;                ///< of Coulomb friction's tanh(qd / v), rad/s
    std::vector<double> torque_constants;       ///< N·m/A of each joint, for currents; empty: estimated
};

/// A recording divided into `count` subsets of `rows` rows each, from row `first` on.
struct TestLog {
    std::filesystem::path log;
    std::size_t first = 0, rows = 0, count = 1;
};

enum class Phase { transient, steady };

/// Divisor of the squared error in ε: the squared output over the same horizon, as in the paper; or the
/// output's variance over all subsets, which does not vanish when an output remains zero.
enum class ErrorScale { horizon, variance };

/// The statement that `better` has a smaller error than `worse`, by a relative `gain` at least. A negative
/// gain accepts that `better` is worse by that amount.
struct Comparison {
    std::string better, worse, group;
    Phase phase = Phase::steady;
    double gain = 0;
};

/// A statement in words and the comparisons that decide it.
struct ExpectedFinding {
    std::string name, statement;
    std::string if_not; ///< shown with the verdict unless the statement is reproduced; may be empty
    std::vector<Comparison> comparisons;
};

/// Cases for comparison in one picture.
struct Figure {
    std::string title;
    std::vector<std::string> cases;
};

/// A plan for `dfdyn evaluate`; see docs/guide/evaluation.md for its file.
struct Plan {
    std::string name; ///< prefix of the pictures' names: letters, digits, '-' and '_'
    std::string title;
    RobotChoice robot;
    OutputKind outputs = OutputKind::wrench;
    std::filesystem::path training_log;
    /// first rows of training_log: for hyperparameters and the initial state
    std::size_t start_rows = 1000;
    std::optional<std::size_t> training_rows;    ///< rows of training_log in use; empty: all
    std::optional<std::size_t> most_online_rows; ///< of the rows behind the first ones; empty: all
    std::vector<TestLog> tests;
    std::size_t horizon = 25;   ///< T
    double steady_after_s = 30; ///< since the beginning of the subset
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

/// Reads a plan. Missing fields are taken from the plan named as "like"; relative paths refer to the plan's
/// folder. Throws InputError with the path of the field for anything missing, unknown, out of range or
/// duplicate, for test rows that are also training rows, and for subsets without a tick that can be scored.
Plan read_plan(const std::filesystem::path& path);

/// Returns the case with this name, which must exist.
const Case& case_named(const Plan& plan, const std::string& name);

/// Returns the plan with one draw and few features, rows and starts: a functional test of all cases in
/// seconds, without meaningful accuracy. It reads the whole training log, and learns at most 400 rows behind
/// the first ones online.
Plan quick_plan(Plan plan);

} // namespace dfdyn::tools
