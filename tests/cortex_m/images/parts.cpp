// SPDX-License-Identifier: Apache-2.0
// Compares the stack that every map and learner uses by itself with its constant expression.
#include "dfdyn/dfdyn.hpp"
#include "report.hpp"
#include "stack_watermark.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

namespace {

using namespace dfdyn;

bool all_within = true;
std::array<std::byte, 50'000> buffer; ///< for snapshots

/// Not inlined, so that its frame is below the painted area.
template <class Call>
[[gnu::noinline]] void run(const Call& call) {
    call();
}

template <class Call>
[[gnu::noinline]] std::uint32_t stack_of(const Call& call) {
    const std::uint32_t* const top = paint_stack();
    run(call);
    return stack_used_bytes(top);
}

/// The predicted bytes must be at least the bytes used and, without the saved registers, at most twice as
/// many.
void check(const char* part, std::uint32_t used, std::int64_t foretold) {
    const bool within = used <= foretold && foretold <= 2 * used + frame_bytes;
    semihosting::write(DFDYN_CORE ": stack of ");
    report(part, used, " of ");
    report("", static_cast<std::uint32_t>(foretold), within ? " bytes\n" : " bytes: not as foretold\n");
    all_within = all_within && within;
}

template <class Scalar, int d>
void check_features(const char* part) {
    constexpr int inputs = 12;
    using Map = RandomFourier<d>;
    static constexpr typename Map::template Constants<Scalar, inputs> constants{};
    static Scalar xi[inputs];
    static Scalar phi[Map::columns];
    check(part, stack_of([] { Map::template evaluate<Scalar, inputs>(constants, {}, {}, xi, phi); }),
          Map::template stack_bytes<Scalar>());
}

/// Constants such that every function of an effect executes all of its steps.
template <class Scalar, class Effect>
void fill_effect(typename Effect::template Constants<Scalar>& constants) {
    for (int c = 0; c < Effect::columns; ++c) {
        constants.row[c] = c % 6;
        if constexpr (requires { constants.sign_velocity; }) {
            constants.sign_velocity[c] = Scalar(0.1);
        }
        if constexpr (requires { constants.stribeck_velocity; }) {
            constants.stribeck_velocity[c] = Scalar(0.5);
        }
        if constexpr (requires { constants.cycles_per_rev; }) {
            constants.cycles_per_rev[c] = 60;
        }
    }
}

/// Constants that select all columns of all bodies and effects.
template <class Arm, PhysicsEffect... Effects>
struct Parts {
    static constexpr int columns = inertial_parameters * Arm::bodies + (0 + ... + Effects::columns);
    using Columns = Physics<DerivativeFreeReduced<10, 3>, columns, Effects...>;

    template <class Scalar>
    static void fill(typename Columns::template Constants<Scalar, Arm>& constants) {
        (..., fill_effect<Scalar, Effects>(constants.effects));
        for (int i = 0; i < constants.motion.rows.size(); ++i) {
            constants.motion.rows[i] = Scalar(0.1) + Scalar(0.01) * static_cast<Scalar>(i);
        }
        for (int i = 0; i < constants.motion.scale.size(); ++i) {
            constants.motion.scale[i] = 1;
            constants.motion_limit[i] = 1000;
        }
        for (int c = 0; c < columns; ++c) {
            constants.selected[c] = c;
            constants.column_scale[c] = 1;
        }
        for (Scalar& gain : constants.output_gain) {
            gain = 1;
        }
    }
};

using TorquesOfSix = Parts<Chain<6>, ViscousFriction<6>, CoulombFriction<6>, StribeckFriction<6>,
                           RotorInertia<6>, TorqueRipple<6>>;
using WrenchOfThree = Parts<Chain<6, WrenchAtSensor<3>>, OutputOffset<6>>;

/// Advances all joints.
template <class AnySample>
void move(AnySample& sample) {
    sample.time_ns += 1'000'000;
    for (int i = 0; i < 6; ++i) {
        sample.position[i] +=
            static_cast<std::remove_reference_t<decltype(sample.position[i])>>(0.01 * (i + 1));
    }
}

/// Returns the maximum stack of `call` over several motions of `sample`.
template <class AnySample, class Call>
std::uint32_t stack_in_motion(AnySample& sample, int ticks, const Call& call) {
    std::uint32_t most = 0;
    for (int t = 0; t < ticks; ++t) {
        move(sample);
        most = std::max(most, stack_of(call));
    }
    return most;
}

template <class Scalar, class Input>
void check_input(const char* part) {
    constexpr int joints = 6;
    using Map = typename Input::template Map<Scalar, joints>;
    static constexpr typename Map::Constants constants{};
    static Map map(constants, {}, {}, {});
    static typename Input::template Sample<Scalar, joints, 1> sample{};
    static Scalar xi[joints * Input::features_per_joint];
    const std::uint32_t used = stack_in_motion(sample, 2 * Input::lags + 2, [] {
        map.push(sample);
        map.evaluate(xi);
    });
    check(part, used, Map::stack_bytes());
}

template <class Scalar, class Arm, class AllParts>
void check_physics(const char* part) {
    using Map = typename AllParts::Columns::template Map<Scalar, Arm>;
    static typename Map::Constants constants{};
    AllParts::template fill<Scalar>(constants);
    static Map map(constants, {});
    static Sample<Scalar, Arm::joints, Arm::outputs> sample{};
    static Scalar psi[Arm::outputs * AllParts::columns];
    static bool evaluated = false;
    const std::uint32_t used = stack_in_motion(sample, 20, [] {
        map.push(sample);
        evaluated = map.evaluate(psi);
    });
    check(part, used, Map::stack_bytes({}));
    all_within = all_within && evaluated;
}

/// Predicts and learns `rows` for `targets`, with forgetting.
template <class Learner, class Scalar, class... Rows>
std::uint32_t learn(Learner& learner, Scalar* means, const Scalar* targets, Rows... rows) {
    const std::uint32_t predicting = stack_of([&] { learner.predict(rows..., means); });
    const std::uint32_t beginning = stack_of([&] { learner.reset(); });
    const std::uint32_t learning = stack_of([&] {
        Budget budget = Budget::unlimited();
        learner.begin(rows..., targets);
        learner.advance(budget);
    });
    return std::max({predicting, beginning, learning});
}

template <class Scalar, template <class, int, int> class Form>
void check_learner(const char* part) {
    constexpr int columns = 50;
    constexpr int outputs = 6;
    using Learner = Form<Scalar, columns, outputs>;
    static constexpr typename Learner::Constants constants{100, Scalar(0.999), nullptr};
    static Learner learner(constants, {}, {});
    static Scalar row[columns] = {1, 2};
    static Scalar targets[outputs] = {1};
    static Scalar means[outputs];
    check(part, learn(learner, means, targets, row), Learner::stack_bytes());
}

template <class Scalar>
void check_block_arrow(const char* part) {
    constexpr int columns = 50;
    constexpr int parameters = 20;
    constexpr int outputs = 6;
    using Learner = BlockArrow<Scalar, columns, parameters, outputs>;
    static constexpr
        typename Learner::Constants constants{{100, Scalar(0.999), nullptr}, {100, Scalar(0.999), nullptr}};
    static Learner learner(constants, {}, {}, {});
    static Scalar phi[columns] = {1, 2};
    static Scalar psi[outputs * parameters] = {1, 2};
    static Scalar targets[outputs] = {1};
    static Scalar means[outputs];
    check(part, learn(learner, means, targets, phi, psi), Learner::stack_bytes());
}

template <class Scalar>
void check_common_parameters(const char* part) {
    constexpr int parameters = 20;
    constexpr int outputs = 6;
    using Learner = CommonParameters<Scalar, parameters, outputs>;
    static constexpr typename Learner::Constants constants{100, Scalar(0.999), nullptr};
    static Learner learner(constants, {}, {});
    static Scalar psi[outputs * parameters] = {1, 2};
    static Scalar targets[outputs] = {1};
    const std::uint32_t used = stack_of([] {
        Budget budget = Budget::unlimited();
        learner.begin(psi, targets, Scalar(1));
        learner.advance(budget);
    });
    check(part, used, Learner::stack_bytes());
}

template <class AnyModel>
void fill_model(typename AnyModel::Constants& constants) {
    using Scalar = typename AnyModel::Scalar;
    constants.gap_ns = 1'500'000;
    constants.period_ns = 1'000'000;
    constants.innovation_limit = Scalar(1e30);
    for (int k = 0; k < AnyModel::outputs; ++k) {
        constants.output_noise_std[k] = 1;
        constants.output_limit[k] = 1000;
    }
    for (Scalar& limit : constants.position_limit) {
        limit = 10;
    }
    if constexpr (AnyModel::parameters > 0) {
        WrenchOfThree::fill<Scalar>(constants.physics);
    }
    if constexpr (requires { constants.learner.common; }) {
        constants.learner = {{100, Scalar(0.999), nullptr}, {100, Scalar(0.999), nullptr}};
    } else if constexpr (requires { constants.learner.residual; }) {
        constants.learner.residual = {100, Scalar(0.999), nullptr};
    } else {
        constants.learner = {100, Scalar(0.999), nullptr};
    }
}

/// Measures ticks with learning, at once and in slices, ticks without a measurement, then snapshot, restore
/// and reset.
template <class AnyModel>
void check_estimator(const char* part) {
    static typename AnyModel::Constants constants{};
    fill_model<AnyModel>(constants);
    static Estimator<AnyModel> estimator(constants);
    static typename AnyModel::Sample sample{};
    static_assert(Estimator<AnyModel>::snapshot_capacity <= buffer.size());
    static int learned = 0;
    static Budget budget{};
    std::uint32_t used = 0;
    for (int t = 0; t < 40; ++t) {
        move(sample);
        sample.output_valid = t % 3 != 0;
        budget.operations = t < 20 ? 1'000'000 : Estimator<AnyModel>::cost().largest_step;
        used = std::max(used,
                        stack_of([] { learned += estimator.tick(sample, budget).status.learned() ? 1 : 0; }));
    }
    used = std::max({used, stack_of([] { static_cast<void>(estimator.snapshot(buffer)); }),
                     stack_of([] { static_cast<void>(estimator.restore(buffer)); }),
                     stack_of([] { estimator.reset(); })});
    check(part, used, Estimator<AnyModel>::footprint().stack_bytes);
    all_within = all_within && learned > 5;
}

template <class Scalar>
void check_all() {
    check_input<Scalar, DerivativeFree<10>>("DF ");
    check_input<Scalar, DerivativeFreeWeighted<10>>("DFW ");
    check_input<Scalar, DerivativeFreeReduced<10, 3>>("DFR ");
    check_input<Scalar, DerivativeFreeStructured<10>>("DFSR ");
    check_input<Scalar, Standard<10>>("adaptive windows ");
    check_input<Scalar, StandardMeasured>("measured derivatives ");
    check_features<Scalar, 50>("random features ");
    check_physics<Scalar, Chain<6>, TorquesOfSix>("physics of six torques ");
    check_physics<Scalar, Chain<6, WrenchAtSensor<3>>, WrenchOfThree>("physics of a wrench ");
    check_learner<Scalar, UdCovariance>("U-D covariance ");
    check_block_arrow<Scalar>("block arrow ");
    check_common_parameters<Scalar>("common parameters ");
    using Input = DerivativeFreeReduced<10, 3>;
    check_estimator<Model<Scalar, Joints<6, 6>, Input, RandomFourier<25>>>("an estimator, NP ");
    using Columns = WrenchOfThree::Columns;
    using Arm = Chain<6, WrenchAtSensor<3>>;
    check_estimator<Model<Scalar, Arm, NoInput, NoFeatures, Parametric<Columns>>>("an estimator, P ");
    check_estimator<Model<Scalar, Arm, Input, RandomFourier<8>, SemiparametricMean<Columns>>>(
        "an estimator, SP ");
    check_estimator<Model<Scalar, Arm, Input, RandomFourier<8>, SemiparametricKernel<Columns>>>(
        "an estimator, SPK ");
}

} // namespace

int application() {
    check_all<float>();
#ifdef DFDYN_CORE_HAS_DOUBLE
    semihosting::write("in double:\n");
    check_all<double>();
#endif
    return all_within ? 0 : 1;
}
