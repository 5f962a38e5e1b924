// SPDX-License-Identifier: Apache-2.0
// What runs in the control loop's period, as functions that may not block: a compiler that knows
// [[clang::nonblocking]] refuses whatever they call that allocates, locks, throws or waits
// (-Wfunction-effects), and RealtimeSanitizer stops the program where one of them does so after all. With the
// argument `block` the program does what must be caught.
#include "dfdyn/dfdyn.hpp"
#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/assembly/wrench_output.hpp"
#include "dfdyn/hal/device/ati_netcan.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "dfdyn/hal/sample_assembly.hpp"
#include "firmware_lib/examples/ur5_model.hpp"
#include "firmware_lib/examples/ur5_ticks.hpp"
#include "tests/firmware_lib/support/test_model.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

// The C library says nothing of its functions; of these it is known that they compute and return.
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

/// What an estimator does within a period.
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

/// What the receive path does within a period.
template <class Assembly>
bool receive(Assembly& assembly, const hal::Frame& frame, std::int64_t now_ns) noexcept
    [[clang::nonblocking]] {
    const auto moment = assembly.take(frame, now_ns);
    return assembly.assemble(moment.instant_ns, now_ns).valid();
}

[[gnu::noinline]] void allocate(int bytes) {
    void* volatile room = std::malloc(static_cast<std::size_t>(bytes));
    std::free(room);
}

/// Hidden from the compiler's check by a pointer; the sanitizer sees it.
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

/// Frames of every kind and identifier, whole and broken.
template <class Assembly>
int run_receive(const typename Assembly::Config& config, const auto& output) {
    const auto assembly = std::make_unique<Assembly>(config, output);
    std::mt19937_64 engine(1);
    int valid = 0;
    for (int k = 0; k < 20'000; ++k) {
        hal::Frame frame;
        frame.stamp_ns = 1'000'000 + 100'000LL * k;
        frame.id = static_cast<std::uint32_t>(engine() % 0x800);
        frame.length = static_cast<std::uint8_t>(engine() % 9);
        frame.error = engine() % 50 == 0;
        frame.remote = engine() % 50 == 0;
        std::generate_n(frame.data.begin(), frame.length,
                        [&] { return static_cast<std::uint8_t>(engine()); });
        valid += receive(*assembly, frame, frame.stamp_ns + 10'000) ? 1 : 0;
    }
    return valid;
}

constexpr hal::TrackConfig track{.max_age_ns = 1'000'000'000'000, .latency_ns = 0, .qualification = {1, 1}};
constexpr hal::Range any_joint{-1e9, 1e9};

template <class Sensor>
hal::WrenchOutput<Sensor, 8> wrench_of(const Sensor& sensor) {
    return {sensor,
            {.track = track,
             .range = {{{-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}}},
             .pairing = {.period_ns = 1'000'000, .delay_ns = 500'000},
             .frozen_limit = 100}};
}

template <class Board, int boards, class Output>
int run_family(const std::array<Board, static_cast<std::size_t>(boards)>& board, const Output& output) {
    using Assembly = hal::SampleAssembly<float, 2, Board, boards, Output, 8>;
    return run_receive<Assembly>({.board = board,
                                  .position = track,
                                  .position_range = {any_joint, any_joint},
                                  .clock = {},
                                  .output_bus = 0},
                                 output);
}

void run_all_families() {
    using namespace dfdyn::hal;
    run_family<icub::TwoJointBoard, 1>({icub::TwoJointBoard(1, {0, 11.375, 0}, {1, 11.375, 0})},
                                       wrench_of(icub::StrainBoard(13)));
    run_family<icub::FocBoard, 2>(
        {icub::FocBoard({.address = 1, .joint = 0}), icub::FocBoard({.address = 2, .joint = 1})},
        wrench_of(RobotousRft(RobotousRft::Config{})));
    run_family<Cia402Drive, 2>({Cia402Drive({.node = 1, .joint = 0}), Cia402Drive({.node = 2, .joint = 1})},
                               EffortOutput<2, 8>({.track = track, .range = {any_joint, any_joint}}));
    run_family<OdriveAxis, 2>({OdriveAxis({.node = 1, .joint = 0}), OdriveAxis({.node = 2, .joint = 1})},
                              wrench_of(AtiNetcan(AtiNetcan::Config{})));
}

} // namespace

int main(int count, char** arguments) {
    if (count > 1 && std::strcmp(arguments[1], "block") == 0) {
        block_after_all(allocate);
        return 0; // not to be reached
    }
    using Input = DerivativeFreeReduced<6, 3>;
    const bool models = run_model<tests::TestModel<float>>() &&
                        run_model<tests::TestModel<double, Standard<6>, 15, CholeskyInformation>>() &&
                        run_model<tests::TestModel<float, DerivativeFreeStructuredRecursive<6>>>() &&
                        run_model<tests::TestParametric<float>>() && run_model<tests::TestMean<float>>() &&
                        run_model<tests::TestKernel<double, Input, 15>>();
    run_all_families();
    const bool good = models && run_ur5();
    std::puts(good ? "realtime: nothing blocked" : "realtime: not as expected");
    return good ? 0 : 1;
}
