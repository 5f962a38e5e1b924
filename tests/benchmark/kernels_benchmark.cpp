// SPDX-License-Identifier: Apache-2.0
// Times of the parts of a tick. `dfdyn bench` measures whole ticks, other learners and the machine's limit.
#include "dfdyn/dfdyn.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/build_flags.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using dfdyn::dynamic;
namespace detail = dfdyn::detail;

template <class Scalar>
dfdyn::Storage<Scalar, dynamic> random_numbers(int count) {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<Scalar> number(-1, 1);
    auto numbers = dfdyn::Storage<Scalar, dynamic>::zeros({count});
    for (Scalar& value : numbers) {
        value = number(engine);
    }
    return numbers;
}

/// Two panels of `rows` rows, and a row and a gain of the same length.
template <class Scalar>
struct Panels {
    int blocks;
    dfdyn::Storage<Scalar, dynamic> panel, next, row, gain;
    detail::PanelFactors<Scalar> factors{{}, {}};
    Scalar products[detail::panel_width] = {};

    explicit Panels(std::int64_t rows)
        : blocks(static_cast<int>(rows) / detail::block_rows<Scalar>),
          panel(random_numbers<Scalar>(blocks * detail::block_size<Scalar>)), next(panel),
          row(random_numbers<Scalar>(blocks * detail::block_rows<Scalar>)), gain(row) {}
};

template <class Scalar>
void panel_products(benchmark::State& state) {
    Panels<Scalar> p(state.range(0));
    for ([[maybe_unused]] auto _ : state) {
        detail::panel_products(p.panel.data(), p.blocks, p.row.data(), p.products);
        benchmark::DoNotOptimize(p.products);
    }
}

template <class Scalar>
void update_panel(benchmark::State& state) {
    Panels<Scalar> p(state.range(0));
    for ([[maybe_unused]] auto _ : state) {
        detail::update_panel(p.panel.data(), p.blocks, p.gain.data(), p.factors);
        benchmark::ClobberMemory();
    }
}

template <class Scalar>
void update_panel_with_next(benchmark::State& state) {
    Panels<Scalar> p(state.range(0));
    for ([[maybe_unused]] auto _ : state) {
        detail::update_panel(p.panel.data(), p.blocks, p.gain.data(), p.factors, p.next.data(), p.blocks,
                             p.row.data(), p.products);
        benchmark::ClobberMemory();
    }
}

template <class Scalar>
void dot(benchmark::State& state) {
    const auto count = static_cast<int>(state.range(0));
    const auto a = random_numbers<Scalar>(count);
    const auto b = random_numbers<Scalar>(count);
    for ([[maybe_unused]] auto _ : state) {
        benchmark::DoNotOptimize(detail::dot(a.data(), b.data(), count));
    }
}

template <class Scalar>
void add_scaled(benchmark::State& state) {
    const auto count = static_cast<int>(state.range(0));
    const auto x = random_numbers<Scalar>(count);
    auto y = random_numbers<Scalar>(count);
    for ([[maybe_unused]] auto _ : state) {
        detail::add_scaled(Scalar(0), x.data(), y.data(), count);
        benchmark::ClobberMemory();
    }
}

/// A separate variance, computed in a tick that does not learn.
template <class Scalar>
void variance(benchmark::State& state) {
    const auto columns = static_cast<int>(state.range(0));
    dfdyn::UdFactor<Scalar, dynamic> factor({columns});
    factor.reset(1);
    const auto row = random_numbers<Scalar>(columns);
    for ([[maybe_unused]] auto _ : state) {
        benchmark::DoNotOptimize(factor.variance(row.data()));
    }
}

/// Learns one row in information form, which `dfdyn bench` does not measure.
void learn_information(benchmark::State& state) {
    const auto columns = static_cast<int>(state.range(0));
    const dfdyn::LearnerConstants<float, dynamic, dynamic> constants{100, 1, nullptr};
    dfdyn::CholeskyInformation<float, dynamic, dynamic> learner(constants, {columns}, {6});
    const auto row = random_numbers<float>(columns);
    const auto target = random_numbers<float>(6);
    for ([[maybe_unused]] auto _ : state) {
        dfdyn::Budget budget = dfdyn::Budget::unlimited();
        learner.begin(row.data(), target.data());
        learner.advance(budget);
    }
}

void cos_sin_dfdyn(benchmark::State& state) {
    const auto count = static_cast<int>(state.range(0));
    const std::vector<float> x(static_cast<std::size_t>(count), 1.5F);
    std::vector<float> c(x);
    std::vector<float> s(x);
    for ([[maybe_unused]] auto _ : state) {
        benchmark::DoNotOptimize(dfdyn::cos_sin(x.data(), count, 0.05F, c.data(), s.data()));
        benchmark::ClobberMemory();
    }
}

void cos_sin_library(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<float> x(count, 1.5F);
    std::vector<float> c(x);
    std::vector<float> s(x);
    for ([[maybe_unused]] auto _ : state) {
        for (std::size_t i = 0; i < count; ++i) {
            c[i] = 0.05F * std::cos(x[i]);
            s[i] = 0.05F * std::sin(x[i]);
        }
        benchmark::ClobberMemory();
    }
}

/// Numbers of rows of panels inside and outside the first-level cache.
void rows(benchmark::internal::Benchmark* benchmark) { benchmark->Arg(64)->Arg(496)->Arg(4096); }

void columns(benchmark::internal::Benchmark* benchmark) { benchmark->Arg(100)->Arg(500)->Arg(1000); }

} // namespace

BENCHMARK(panel_products<float>)->Apply(rows);
BENCHMARK(panel_products<double>)->Apply(rows);
BENCHMARK(update_panel<float>)->Apply(rows);
BENCHMARK(update_panel<double>)->Apply(rows);
BENCHMARK(update_panel_with_next<float>)->Apply(rows);
BENCHMARK(update_panel_with_next<double>)->Apply(rows);
BENCHMARK(dot<float>)->Apply(columns);
BENCHMARK(dot<double>)->Apply(columns);
BENCHMARK(add_scaled<float>)->Apply(columns);
BENCHMARK(variance<float>)->Apply(columns);
BENCHMARK(variance<double>)->Apply(columns);
BENCHMARK(learn_information)->Apply(columns);
BENCHMARK(cos_sin_dfdyn)->Arg(250);
BENCHMARK(cos_sin_library)->Arg(250);

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::AddCustomContext("build", dfdyn::tools::build_flags());
    benchmark::RunSpecifiedBenchmarks();
}
