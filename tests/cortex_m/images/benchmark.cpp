// SPDX-License-Identifier: Apache-2.0
// Benchmark of a tick of a model with DFDYN_JOINTS joints, six outputs and DFDYN_FEATURES random features (2d
// columns): instructions for predicting, and for predicting and learning; stack; and the bytes that the
// constant expressions predict.
#include "dfdyn/dfdyn.hpp"
#include "instruction_counter.hpp"
#include "report.hpp"
#include "stack_watermark.hpp"

extern "C" std::uint32_t data_begin[], bss_end[];

namespace {

using Scalar = DFDYN_SCALAR;
using Model = dfdyn::Model<Scalar, dfdyn::Joints<DFDYN_JOINTS, 6>, dfdyn::DerivativeFreeReduced<10, 3>,
                           dfdyn::RandomFourier<DFDYN_FEATURES>>;
using Estimator = dfdyn::Estimator<Model>;
constexpr dfdyn::Footprint footprint = Estimator::footprint();

/// Pseudo-random numbers in [-1, 1]. Their values do not matter: a tick executes the same instructions for
/// any values.
constexpr Scalar any_number(std::uint32_t& state) {
    state = state * 1664525U + 1013904223U;
    return static_cast<Scalar>(static_cast<std::int32_t>(state)) / Scalar(2147483648.0);
}

template <class Numbers>
constexpr void fill(Numbers& numbers, Scalar size, std::uint32_t& state) {
    for (Scalar& number : numbers) {
        number = size * any_number(state);
    }
}

constexpr dfdyn::LearnerStart<Scalar, Model::columns, Model::outputs> make_start() {
    dfdyn::LearnerStart<Scalar, Model::columns, Model::outputs> start{};
    std::uint32_t state = 1;
    fill(start.weights, 1, state);
    fill(start.unit_upper, Scalar(0.01), state);
    for (Scalar& value : start.diagonal) {
        value = 1;
    }
    return start;
}
constexpr auto start = make_start();

constexpr Model::Constants make_constants() {
    Model::Constants constants{};
    std::uint32_t state = 2;
    constants.gap_ns = 1'500'000;
    constants.period_ns = 1'000'000;
    fill(constants.input.rows, 1, state);
    fill(constants.input.scale, 1, state);
    fill(constants.features.frequencies, 1, state);
    constants.features.amplitude = Scalar(0.1);
    for (int k = 0; k < Model::outputs; ++k) {
        constants.output_noise_std[k] = 1;
        constants.output_limit[k] = 1000;
    }
    for (Scalar& limit : constants.position_limit) {
        limit = 10;
    }
    constants.innovation_limit = Scalar(1e30);
    constants.learner = {1000, Scalar(0.9995), &start};
    return constants;
}
constexpr Model::Constants constants = make_constants();
Estimator estimator(constants);

struct Measured {
    std::uint32_t instructions = 0; ///< of the most expensive tick
    std::uint32_t stack_bytes = 0;
    bool as_expected = true;
};

[[gnu::noinline]] dfdyn::Reason tick(const Estimator::Sample& sample, dfdyn::Budget budget) {
    return estimator.tick(sample, budget).status.reason();
}

[[gnu::noinline]] Measured measure(dfdyn::Budget budget, dfdyn::Reason expected) {
    Measured measured;
    std::uint32_t state = 3;
    Estimator::Sample sample{};
    sample.output_valid = true;
    estimator.reset();
    for (int t = 0; t < 40; ++t) {
        sample.time_ns += 1'000'000;
        fill(sample.position, 1, state);
        fill(sample.output, 1, state);
        const std::uint32_t* const top = paint_stack();
        const std::uint32_t before = instruction_counter();
        const dfdyn::Reason reason = tick(sample, budget);
        const std::uint32_t instructions = instruction_counter() - before;
        measured.instructions = std::max(measured.instructions, instructions);
        measured.stack_bytes = std::max(measured.stack_bytes, stack_used_bytes(top));
        measured.as_expected = measured.as_expected && (t < 10 || reason == expected);
    }
    return measured;
}

std::uint32_t ram_bytes() { return static_cast<std::uint32_t>(bss_end - data_begin) * 4; }

} // namespace

int application() {
    if (!counter_is_exact()) {
        return 4;
    }
    const Measured predict = measure(dfdyn::Budget::predict_only(), dfdyn::Reason::no_budget);
    const Measured learn = measure(dfdyn::Budget::unlimited(), dfdyn::Reason::ok);
    const std::uint32_t stack = std::max(predict.stack_bytes, learn.stack_bytes);
    report(DFDYN_CORE ": benchmark: joints ", DFDYN_JOINTS, ", columns ");
    report("", Model::columns, sizeof(Scalar) == 4 ? ", float" : ", double");
    report(": instructions: predict ", predict.instructions, ", predict and learn ");
    report("", learn.instructions, "; operations: ");
    report("", static_cast<std::uint32_t>(Estimator::cost().predict + Estimator::cost().variance), ", ");
    report("",
           static_cast<std::uint32_t>(Estimator::cost().predict + Estimator::cost().learn +
                                      Estimator::cost().forget),
           "; state ");
    report("", static_cast<std::uint32_t>(footprint.state_bytes), " bytes, constants ");
    report("", static_cast<std::uint32_t>(footprint.constant_bytes), " bytes, stack ");
    report("", stack, " of ");
    report("", static_cast<std::uint32_t>(footprint.stack_bytes), " bytes\n");
    const bool good = predict.as_expected && learn.as_expected && stack <= footprint.stack_bytes &&
                      learn.instructions <= DFDYN_INSTRUCTION_CEILING &&
                      ram_bytes() + stack <= DFDYN_RAM_CEILING;
    return good ? 0 : 1;
}
