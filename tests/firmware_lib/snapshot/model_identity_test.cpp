// SPDX-License-Identifier: Apache-2.0
// A snapshot belongs to one type of model. Types with equal sizes and identities of their constants are
// different models, because the same numbers have a different meaning.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <functional>
#include <string>

namespace model_identity_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Bytes = std::vector<std::byte>;

constexpr int lags = 2; // so that DF also has three features per joint
using Reduced = DerivativeFreeReduced<lags, 3>;
template <class Motion, PhysicsEffect Effect>
using OtherPhysics = Physics<Motion, two_link_column_count, Effect, OutputOffset<2>>;
template <PhysicsEffect Effect>
using OtherParametric =
    Model<float, Chain<2>, NoInput, NoFeatures, Parametric<OtherPhysics<Reduced, Effect>>>;

/// One type of model, for tests of every pair.
struct ModelKind {
    std::string name;
    Bytes snapshot;
    std::function<SnapshotResult(const Bytes&)> restore; ///< into a new estimator of this type
};

template <class Model>
ModelKind kind(std::string name, std::mt19937_64& engine) {
    auto constants = make_constants<Model>(engine);
    constants.identity = 7;
    const Estimator<Model> estimator(constants);
    return {std::move(name), snapshot_of(estimator), [constants](const Bytes& bytes) {
                Estimator<Model> other(constants);
                return other.restore(bytes);
            }};
}

std::vector<ModelKind> kinds(std::mt19937_64& engine) {
    return {
        kind<TestModel<float, DerivativeFree<lags>>>("NP, DF", engine),
        kind<TestModel<float, DerivativeFreeWeighted<lags>>>("NP, DFW", engine),
        kind<TestModel<float, Reduced>>("NP, DFR", engine),
        kind<TestModel<float, DerivativeFreeStructured<lags>>>("NP, DFSR", engine),
        kind<TestModel<float, Standard<lags>>>("NP, STD", engine),
        kind<TestModel<float, StandardMeasured>>("NP, measured STD", engine),
        kind<TestModel<double, Reduced>>("NP, DFR, double", engine),
        kind<TestParametric<float, Reduced>>("P, DFR", engine),
        kind<TestParametric<float, DerivativeFreeStructured<lags>>>("P, DFSR", engine),
        kind<TestParametric<float, Standard<lags>>>("P, STD", engine),
        kind<OtherParametric<RotorInertia<2>>>("P, rotor inertia for friction", engine),
        kind<OtherParametric<JointSpring<2>>>("P, joint spring for friction", engine),
        kind<TestMean<float, Reduced>>("SP, DFR", engine),
        kind<TestMean<float, DerivativeFree<lags>, 8, Reduced>>("SP, DF on DFR", engine),
        kind<TestMean<float, Reduced, 8, Standard<lags>>>("SP, DFR on STD", engine),
        kind<TestKernel<float, Reduced>>("SPK, DFR", engine),
        kind<TestKernel<float, DerivativeFree<lags>, 8, Reduced>>("SPK, DF on DFR", engine),
        kind<TestKernel<float, Reduced, 8, Standard<lags>>>("SPK, DFR on STD", engine),
    };
}

TEST_CASE("a snapshot of one type of model is rejected by every other type even with equal identities") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<ModelKind> all = kinds(engine);
    for (const ModelKind& from : all) {
        for (const ModelKind& to : all) {
            CAPTURE(from.name, to.name);
            const bool same_kind = &from == &to;
            CHECK(to.restore(from.snapshot) ==
                  (same_kind ? SnapshotResult::ok : SnapshotResult::wrong_model));
        }
    }
}

TEST_CASE("a snapshot belongs to the selected columns of the physics") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<TestParametric<float>>(engine);
    const Estimator<TestParametric<float>> estimator(constants);
    const Bytes snapshot = snapshot_of(estimator);
    Estimator<TestParametric<float>> other(constants);
    CHECK(other.restore(snapshot) == SnapshotResult::ok);
    ++constants.physics.selected[two_link_column_count - 1];
    CHECK(other.restore(snapshot) == SnapshotResult::wrong_model);
}

} // namespace model_identity_test
