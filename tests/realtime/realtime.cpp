// SPDX-License-Identifier: Apache-2.0
// Functions that run in the control loop's period and therefore must not block. A compiler that supports
// [[clang::nonblocking]] rejects calls that allocate, lock, throw or wait (-Wfunction-effects).
// RealtimeSanitizer stops the program at such a call at run time. With the argument `block` the program does
// what must be detected.
#include "dfdyn/dfdyn.hpp"
#include "examples/01_embed/ur5_ticks.hpp"
#include "examples/ur5/ur5_model.hpp"
#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/hal/fuzz/assemblies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>

// The headers of the C library do not declare these functions as nonblocking, but they only compute and
// return.
extern "C" {
double exp(double) noexcept [[clang::nonblocking]];
double log(double) noexcept [[clang::nonblocking]];
double tanh(double) noexcept [[clang::nonblocking]];
double hypot(double, double) noexcept [[clang::nonblocking]];
float expf(float) noexcept [[clang::nonblocking]];
float logf(float) noexcept [[clang::nonblocking]];
float tanhf(float) noexcept [[clang::nonblocking]];
float hypotf(float, float) noexcept [[clang::nonblocking]];
}

namespace {

using namespace dfdyn;

/// One period of an estimator.
template <class Model>
bool tick(Estimator<Model>& estimator, const typename Model::Sample& sample, Budget budget) noexcept
    [[clang::nonblocking]] {
    const bool predicted = estimator.tick(sample, budget).status.predicted();
    estimator.advance(budget);
    return predicted;
}
template <class Model>
SnapshotResult pass_on(const Estimator<Model>& from, Estimator<Model>& to, std::span<std::byte> room) noexcept
    [[clang::nonblocking]] {
    const SnapshotResult taken = from.snapshot(room);
    return taken == SnapshotResult::ok ? to.restore(room) : taken;
}

/// One period of the receive path, for an arm with every kind of device.
bool receive(tests::EveryArm& arms, const hal::Frame& frame, std::int64_t now_ns) noexcept
    [[clang::nonblocking]] {
    return arms.take(frame, now_ns);
}

[[gnu::noinline]] void allocate(int bytes) {
    void* volatile room = std::malloc(static_cast<std::size_t>(bytes));
    std::free(room);
}

/// Blocks through a pointer, which the compiler cannot check but the sanitizer can.
void block_after_all(void (*call)(int)) noexcept [[clang::nonblocking]] {
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wfunction-effects"
    call(1000);
#pragma clang diagnostic pop
}

#ifdef DFDYN_MUST_NOT_COMPILE
void block() noexcept [[clang::nonblocking]] { allocate(8); }
#endif

bool run_ur5() {
    static Estimator<ur5_model::Model> estimator(ur5_model::constants);
    int predicted = 0;
    for (const Ur5Sample& recorded : ur5_samples) {
        const auto sample = read_sensors<ur5_model::Model::Sample>(recorded);
        predicted += tick(estimator, sample, {estimator.cost().learn / 2}) ? 1 : 0;
    }
    return predicted > 250;
}

template <class Model>
bool run_model() {
    std::mt19937_64 engine(1);
    const auto constants = tests::make_constants<Model>(engine, 0.99);
    const auto estimator = std::make_unique<Estimator<Model>>(constants);
    const auto other = std::make_unique<Estimator<Model>>(constants);
    int predicted = 0;
    for (int t = 0; t < 200; ++t) {
        auto sample = tests::moving_sample<Model>(t, engine);
        sample.position[0] =
            t % 50 == 0 ? std::numeric_limits<typename Model::Scalar>::quiet_NaN() : sample.position[0];
        predicted += tick(*estimator, sample, {t % 3 == 0 ? 100 : 1'000'000}) ? 1 : 0;
    }
    std::vector<std::byte> room(estimator->snapshot_bytes());
    return predicted > 100 && pass_on(*estimator, *other, room) == SnapshotResult::ok;
}

/// Receives frames of the devices, mixed with frames of every kind and identifier, valid and broken.
bool run_receive() {
    std::mt19937_64 engine(1);
    const auto arms = std::make_unique<tests::EveryArm>();
    std::int64_t now_ns = 1'000'000'000;
    bool sound = true;
    for (int round = 0; round < 1000; ++round) {
        for (hal::Frame frame : arms->good_frames(std::sin(1e-2 * round))) {
            if (engine() % 5 == 0) {
                frame.id = static_cast<std::uint32_t>(engine() % 0x800);
                frame.length = static_cast<std::uint8_t>(engine() % 9);
                frame.error = engine() % 50 == 0;
                frame.remote = engine() % 50 == 0;
                std::generate_n(frame.data.begin(), frame.length,
                                [&] { return static_cast<std::uint8_t>(engine()); });
            }
            now_ns += 50'000;
            frame.stamp_ns = now_ns - 10'000;
            sound = receive(*arms, frame, now_ns) && sound;
        }
    }
    return sound && arms->samples() > 1000 && arms->outputs() > 100;
}

} // namespace

int main(int count, char** arguments) {
    if (count > 1 && std::strcmp(arguments[1], "block") == 0) {
        block_after_all(allocate);
        return 0; // must not be reached
    }
    using Input = DerivativeFreeReduced<6, 3>;
    const bool models = run_model<tests::TestModel<float>>() &&
                        run_model<tests::TestModel<double, Standard<6>, 15>>() &&
                        run_model<tests::TestModel<float, DerivativeFreeStructured<6>>>() &&
                        run_model<tests::TestParametric<float>>() && run_model<tests::TestMean<float>>() &&
                        run_model<tests::TestKernel<double, Input, 15>>();
    const bool good = models && run_ur5() && run_receive();
    std::puts(good ? "realtime: nothing blocked" : "realtime: not as expected");
    return good ? 0 : 1;
}
