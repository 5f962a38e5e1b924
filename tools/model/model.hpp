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

/// Source of the velocities and accelerations of input STD.
enum class Derivatives {
    estimated, ///< from the positions, by the adaptive window
    measured,  ///< columns qd, qdd of the recording
};

inline constexpr int largest_lag_count = 1000; ///< of any input

/// Conversion of each joint's last positions to k features: xi_(i,j) = relevance-scaled row j of R applied to
/// joint i. Element (i, j) of xi has index i * rows_per_joint + j.
struct InputModel {
    InputKind kind = InputKind::DFR;
    int lags = 0; ///< M; the window holds M+1 positions per joint. STD: the longest window minus one.
    int rows_per_joint = 0; ///< k
    /// k x (M+1), row-major, newest lag first; empty for STD. DF: identity, DFW: diagonal, DFR: free rows
    /// (row 0 = position), DFSR: rows computed from `alpha` and `beta`.
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
    std::uint64_t seed = 0;    ///< seed of omega, for information only: omega itself is stored
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

/// Deviations of joints without contact (see dfdyn::ContactDetector), m x 3: per joint stationary, changing,
/// moving. Empty: not measured, because the outputs are a wrench or the model is of an older version.
struct ContactModel {
    std::vector<double> limit;                ///< smallest deviation of a contact, > 0
    std::vector<double> usual;                ///< median, >= 0
    std::vector<double> relative{};           ///< m: added limit per change of the prediction, >= 0
    std::vector<double> speed{};              ///< m: largest usual, rad/s
    std::vector<double> acceleration{};       ///< m: largest usual, rad/s²
    std::vector<double> standard_deviation{}; ///< m: of a prediction, median, > 0; empty in older models
    std::vector<double> hysteresis{};         ///< m: of dry friction, >= 0; empty in older models
    /// Relative decrease of all limits per factor e of the rate of false contacts, from
    /// `contact_rate_per_hour` on. 0: unknown, the model is of an older version.
    double rate_slope = 0;
};

/// Rate of false contacts, per hour, at the limits of a ContactModel.
inline constexpr double contact_rate_per_hour = 0.1;

/// Plausible range of the sensors; samples beyond it are rejected.
struct LimitModel {
    std::vector<double> position_rad; ///< largest |q_i|
    std::vector<double> output;       ///< largest |y_k|
    double innovation = 0; ///< threshold of the normalised innovation squared for a contradicting sample
    int innovation_patience = 0; ///< number of contradicting samples after which the arm counts as changed
    std::vector<double> prediction{}; ///< largest |prediction|, > 0; empty: no bound
};

/// Uncertainty of the outputs away from the training data (see dfdyn::Extrapolation). Empty: the paper's
/// predictions and standard deviations. Variances in units of noise_std squared.
struct ExtrapolationModel {
    double inverse_far_variance = 0;    ///< 1 / φ'Pφ for a φ unrelated to the data; P: 0
    std::vector<double> extra_noise;    ///< m: variance near the data in addition to the noise; >= 0
    std::vector<double> prior_variance; ///< m: prior variance of the features' contribution; P: zeros
    /// P, SPK of a known robot, m, > 0: variance of an output about its offset without any data. Empty: the
    /// paper's variance of the physics' parameters is used.
    std::vector<double> output_variance;
    double parameter_variance_factor = 1; ///< factor on this variance; >= 1; read with output_variance
};

/// Initial state of the learning: weights of each output, and the unit-upper-triangular and diagonal factors
/// of the covariance P = U D U'.
struct StartModel {
    std::vector<double> weights; ///< m x 2d, row-major, in units of noise_std
    std::vector<double>
        unit_upper; ///< strictly upper part of U by columns: column j holds rows 0 … j-1; 2d(2d-1)/2 values
    std::vector<double> diagonal; ///< 2d values of D
};

/// Geometry of a serial chain, as compiled into the firmware.
struct ChainModel {
    struct Frame {
        std::array<double, 9> rotation{}; ///< row-major
        std::array<double, 3> translation{};
    };
    struct Joint {
        std::string name;
        Frame placement; ///< of the link's frame in the previous link's frame, at position 0
        std::array<double, 3> axis{};
        bool prismatic = false;
    };
    struct Sensor {
        std::string joint;
        int link = 0;    ///< link that carries it: 0 the base, i the link of joint i
        Frame placement; ///< in that link's frame
        bool parent_to_child = false;
    };
    std::vector<Joint> joints;
    std::array<double, 3> gravity{}; ///< m/s^2, in the base's frame
    std::optional<Sensor> sensor; ///< if present, the outputs are its wrench; otherwise the joints' torques
};

/// One column of a named effect.
struct EffectModel {
    std::string name;
    int row = 0;                  ///< index of the output on which it acts, from 0
    double sign_velocity = 0;     ///< coulomb_friction, stribeck_friction (rad/s)
    double stribeck_velocity = 0; ///< stribeck_friction (rad/s)
    double cycles_per_rev = 0;    ///< torque_ripple
    double phase = 0;             ///< torque_ripple (rad)
};

/// A rigid body with friction, fitted to the training recordings by least squares, as a reference for the
/// learned models. Output k is output_gain[k] times the rigid body's torque, plus its friction terms.
struct RigidBodyFit {
    bool identified = false;         ///< inertia: fitted; otherwise from the robot file
    double sign_velocity = 0;        ///< v of dry friction's tanh(qd / v), rad/s
    std::vector<double> output_gain; ///< m: output per N·m (N)
    std::vector<double> inertia; ///< ten per body: kg, kg·m, kg·m²; 0 where the recordings determine none
    /// m × 3, in the outputs' units: per rad/s, times tanh(qd / v), constant. Wrench: the constants only.
    std::vector<double> friction;
};

/// The physics of P, SP, SP2 and SPK: y = psi pi + …, where psi is a selection of all columns: ten per body
/// from base to tip, then the effects.
struct PhysicsModel {
    ChainModel chain;
    InputModel motion; ///< STD, or DFR with three rows in 1, 1/s, 1/s^2; scale 1
    std::vector<EffectModel> effects;
    std::vector<double> motion_limit;         ///< 3 n: largest |q|, |qd|, |qdd| of each joint
    std::vector<int> selected;                ///< p, ascending indices among all columns
    std::vector<std::string> parameter_names; ///< p, with unit: "link2 mcx (kg m)"
    std::vector<double> column_scale;         ///< p: the physical parameter is scale * pi
    std::vector<double> output_gain;          ///< m: output per N m
    double prior_variance = 0;                ///< of each pi in units of the noise; 0: pi is fixed (SP, SP2)
    StartModel start;                     ///< pi and the factor of its covariance; no factor if pi is fixed
    std::vector<double> coupling;         ///< SPK: per output and column of psi, its 2d weights
    std::vector<RigidBodyFit> rigid_body; ///< for the same chain; may be empty; not used by estimators
};

/// Needs and held-out error of the model with a number of features, as compared in training.
struct SizeRecord {
    int features = 0;
    std::int64_t flash_bytes = 0;
    std::int64_t ram_bytes = 0;
    std::int64_t tick_operations = 0;
    double error = 0; ///< mean nRMSE over the outputs, one step ahead, on held-out rows
};

/// Origin of the constants.
struct TrainingRecord {
    std::vector<std::string> recordings; ///< file names without folders
    std::string rows;                    ///< FIRST:LAST as given
    std::string method;                  ///< "ML"
    std::uint64_t seed = 0;
    int likelihood_rows = 0;        ///< samples in the exact kernel
    double log_likelihood = 0;      ///< of the best start
    std::vector<double> all_starts; ///< log likelihood reached from each start
    /// How the recordings were read, as given to `--columns` and `--units`; `replay` reads others in the same
    /// way unless it is given its own.
    std::string columns = {};
    std::string units = {};
    std::vector<std::string> joint_names = {}; ///< of the chain; empty: no robot was given
    std::vector<SizeRecord> sizes = {};        ///< numbers of features that were compared; empty: none
};

/// All results of `dfdyn train`: the content of model.json.
struct TrainedModel {
    std::string structure = "NP"; ///< NP, P, SP, SP2 or SPK
    int joints = 0;
    double sample_period_s = 0;
    double forgetting_factor = 1;
    InputModel input;      ///< P: unused, like the next two
    FeatureModel features; ///< P: count 0
    std::optional<PhysicsModel> physics;
    OutputModel outputs;
    LimitModel limits;
    ContactModel contact;
    std::optional<ExtrapolationModel> extrapolation; ///< empty: as in the paper
    StartModel start;
    TrainingRecord training;
};

} // namespace dfdyn::tools
