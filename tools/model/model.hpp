// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The five inputs of the paper (section "Derivative-free Learning"), by their names on the command line.
enum class InputKind { STD, DF, DFW, DFR, DFSR };

/// Where velocities and accelerations of input STD come from.
enum class Derivatives {
    estimated, ///< from the positions, by the adaptive window
    measured,  ///< columns qd, qdd of the recording
};

inline constexpr int largest_lag_count = 1000; ///< of any input

/// How each joint's last positions become k features: xi_(i,j) = relevance-scaled row j of R applied to joint
/// i. Element (i, j) of xi has index i * rows_per_joint + j.
struct InputModel {
    InputKind kind = InputKind::DFR;
    int lags = 0; ///< M; the window holds M+1 positions per joint. STD: the longest window minus one.
    int rows_per_joint = 0; ///< k
    /// k x (M+1), row-major, newest lag first; empty for STD. DF: identity, DFW: diagonal, DFR: free rows
    /// (row 0 = position), DFSR: rows that follow from `alpha` and `beta`.
    std::vector<double> rows;
    std::vector<double> scale; ///< n*k factors applied to R q (relevance / standard deviation over training)
    std::array<double, 2> alpha{}; ///< DFSR only: gains of the velocity and acceleration rows
    std::array<double, 2> beta{};  ///< DFSR only: poles of their low-pass filters, in (0, 1)
    Derivatives derivatives = Derivatives::estimated; ///< STD only
    double position_noise_bound = 0; ///< STD, estimated: bound of the position error (rad) for the window
};

/// Random features: phi = [cos(omega xi / l); sin(omega xi / l)] / sqrt(d).
struct FeatureModel {
    bool orthogonal = false;
    int count = 0;             ///< d; 2d columns
    std::uint64_t seed = 0;    ///< the seed that drew omega (kept for the record; omega itself is stored)
    std::vector<double> omega; ///< d x (n*k), row-major, before division by the length scale
    double length_scale = 1;   ///< l of K_G = exp(-|x-x'|^2 / (2 l^2))
};

/// Per output: y = offset + noise_std * (phi' w + e), e ~ N(0, 1), w ~ N(0, prior_variance I).
struct OutputModel {
    std::vector<std::string> names; ///< column names, e.g. i1 … i6
    std::vector<double> offset;
    std::vector<double> noise_std;
    double prior_variance = 1; ///< rho^2 / sigma^2, shared: the outputs share one factor
};

/// What the sensors can plausibly show; samples beyond are refused.
struct LimitModel {
    std::vector<double> position_rad; ///< |q_i| at most
    std::vector<double> output;       ///< |y_k| at most
    double innovation = 0;            ///< normalised innovation squared beyond which a sample contradicts
    int innovation_patience = 0;      ///< samples of contradiction that make a changed arm
    std::vector<double> prediction{}; ///< |prediction| at most, > 0; empty: no bound
};

/// What a model knows of the outputs away from its data (see dfdyn::Extrapolation). Empty: the paper's
/// predictions and standard deviations. Variances in units of noise_std squared.
struct ExtrapolationModel {
    double inverse_far_variance = 0;    ///< 1 / φ'Pφ at a φ that has nothing in common with the data; P: 0
    std::vector<double> extra_noise;    ///< m: variance near the data beyond the noise's; >= 0
    std::vector<double> prior_variance; ///< m: of what the features add, where nothing is known; P: zeros
    /// P, SPK of a known robot, m, > 0: of an output about its offset where nothing is known. Empty: the
    /// variance of the physics' parameters is the paper's.
    std::vector<double> output_variance;
    double parameter_variance_factor =
        1; ///< times that this variance counts; >= 1; read with output_variance
};

/// Where learning starts: weights of each output and the unit-upper-triangular / diagonal factor of the
/// covariance P = U D U'.
struct StartModel {
    std::vector<double> weights; ///< m x 2d, row-major, in units of noise_std
    std::vector<double>
        unit_upper; ///< strictly upper part of U by columns: column j holds rows 0 … j-1; 2d(2d-1)/2 values
    std::vector<double> diagonal; ///< 2d values of D
};

/// A serial chain's geometry: what the firmware compiles in of a robot.
struct ChainModel {
    struct Frame {
        std::array<double, 9> rotation{}; ///< row-major
        std::array<double, 3> translation{};
    };
    struct Joint {
        std::string name;
        Frame placement; ///< of the link's frame in the previous link's, at position 0
        std::array<double, 3> axis{};
        bool prismatic = false;
    };
    struct Sensor {
        std::string joint;
        int link = 0;    ///< that carries it: 0 the base, i the link of joint i
        Frame placement; ///< in that link's frame
        bool parent_to_child = false;
    };
    std::vector<Joint> joints;
    std::array<double, 3> gravity{}; ///< m/s^2, in the base's frame
    std::optional<Sensor> sensor;    ///< the outputs are its wrench; otherwise the joints' torques
};

/// One column of a named effect, as interfaces name it.
struct EffectModel {
    std::string name;
    int row = 0;                  ///< output that it acts on, from 0
    double sign_velocity = 0;     ///< coulomb_friction, stribeck_friction (rad/s)
    double stribeck_velocity = 0; ///< stribeck_friction (rad/s)
    double cycles_per_rev = 0;    ///< torque_ripple
    double phase = 0;             ///< torque_ripple (rad)
};

/// A rigid body with friction, fitted to the training's recordings by least squares: what the learned models
/// are compared with. Output k is output_gain[k] times the rigid body's torque, plus its friction terms.
struct RigidBodyFit {
    bool identified = false;         ///< inertia: fitted; otherwise the robot file's
    double sign_velocity = 0;        ///< v of dry friction's tanh(qd / v), rad/s
    std::vector<double> output_gain; ///< m: output per N·m (N)
    std::vector<double> inertia; ///< ten per body: kg, kg·m, kg·m²; 0 where the training determines none
    /// m × 3, in the outputs' units: per rad/s, times tanh(qd / v), constant. Wrench: the constants only.
    std::vector<double> friction;
};

/// The physics of P, SP, SP2 and SPK: y = psi pi + …, psi of all columns - ten per body, base to tip, then
/// the effects - of which some are selected.
struct PhysicsModel {
    ChainModel chain;
    InputModel motion; ///< STD, or DFR with three rows in 1, 1/s, 1/s^2; scale 1
    std::vector<EffectModel> effects;
    std::vector<double> motion_limit;         ///< 3 n: |q|, |qd|, |qdd| of each joint at most
    std::vector<int> selected;                ///< p, ascending, among all columns
    std::vector<std::string> parameter_names; ///< p, with unit: "link2 mcx (kg m)"
    std::vector<double> column_scale;         ///< p: the physical parameter is scale * pi
    std::vector<double> output_gain;          ///< m: output per N m
    double prior_variance = 0;                ///< of each pi in units of the noise; 0: pi is fixed (SP, SP2)
    StartModel start;                         ///< pi and the factor of its covariance; fixed: no factor
    std::vector<double> coupling;             ///< SPK: of each output, of each column of psi, its 2d weights
    std::vector<RigidBodyFit> rigid_body;     ///< on the same chain; may be empty; no estimator reads it
};

/// Where the constants came from.
struct TrainingRecord {
    std::vector<std::string> recordings; ///< file names without folders
    std::string rows;                    ///< FIRST:LAST as given
    std::string method;                  ///< "ML"
    std::uint64_t seed = 0;
    int likelihood_rows = 0;        ///< samples in the exact kernel
    double log_likelihood = 0;      ///< of the winning start
    std::vector<double> all_starts; ///< log likelihood reached from each start
};

/// Everything that `dfdyn train` fixes: the content of model.json.
struct TrainedModel {
    std::string structure = "NP"; ///< NP, P, SP, SP2 or SPK
    int joints = 0;
    double sample_period_s = 0;
    double forgetting_factor = 1;
    InputModel input;      ///< P: none of the next two
    FeatureModel features; ///< P: count 0
    std::optional<PhysicsModel> physics;
    OutputModel outputs;
    LimitModel limits;
    std::optional<ExtrapolationModel> extrapolation; ///< nothing: the paper's
    StartModel start;
    TrainingRecord training;
};

} // namespace dfdyn::tools
