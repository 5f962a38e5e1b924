// SPDX-License-Identifier: Apache-2.0
// Time per sample of "predict six outputs, learn one row, have the weights", against what one would write
// with Eigen.
#include "dfdyn/dfdyn.hpp"
#include "tools/build_flags.hpp"
#include "tools/host/dynamic_storage.hpp"

#include <Eigen/Cholesky>
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

constexpr int outputs = 6;
constexpr float prior_variance = 100;

/// Random Fourier features of random inputs, cycled.
class Rows {
  public:
    explicit Rows(int columns) : columns_(columns), values_(static_cast<std::size_t>(count * columns)) {
        std::mt19937_64 engine(1);
        std::normal_distribution<float> normal(0, 1 / std::sqrt(static_cast<float>(columns)));
        for (float& value : values_) {
            value = normal(engine);
        }
    }
    const float* next() {
        position_ = (position_ + 1) % count;
        return values_.data() + position_ * columns_;
    }

  private:
    static constexpr int count = 128;
    int columns_;
    int position_ = 0;
    std::vector<float> values_;
};

constexpr float target[outputs] = {1, -2, 3, -4, 5, -6};

template <template <class, int, int> class Form>
void learn(benchmark::State& state) {
    using dfdyn::dynamic;
    const auto columns = static_cast<int>(state.range(0));
    const dfdyn::LearnerConstants<float, dynamic, dynamic> constants{prior_variance, 1, nullptr};
    Form<float, dynamic, dynamic> learner(constants, {columns}, {outputs});
    Rows rows(columns);
    float means[outputs];
    for ([[maybe_unused]] auto _ : state) {
        const float* row = rows.next();
        learner.predict(row, means);
        benchmark::DoNotOptimize(means);
        learner.begin(row, target);
        dfdyn::Budget budget = dfdyn::Budget::unlimited();
        learner.advance(budget);
    }
}

/// The textbook: rank-one update of the Cholesky factor, then two triangular solves for the weights.
void eigen_rank_update(benchmark::State& state) {
    const auto columns = state.range(0);
    using Matrix = Eigen::MatrixXf;
    Eigen::LLT<Matrix> factor(Matrix(Matrix::Identity(columns, columns) / prior_variance));
    Matrix right = Matrix::Zero(columns, outputs);
    Matrix weights = right;
    Rows rows(static_cast<int>(columns));
    const Eigen::Map<const Eigen::Matrix<float, outputs, 1>> y(target);
    for ([[maybe_unused]] auto _ : state) {
        const Eigen::Map<const Eigen::VectorXf> row(rows.next(), columns);
        Eigen::Matrix<float, outputs, 1> means = weights.transpose() * row;
        benchmark::DoNotOptimize(means.data());
        factor.rankUpdate(row, 1);
        right.noalias() += row * y.transpose();
        weights = factor.solve(right);
    }
}

/// The plain covariance recursion, fast and inaccurate.
void eigen_covariance(benchmark::State& state) {
    const auto columns = state.range(0);
    using Matrix = Eigen::MatrixXf;
    Matrix covariance = Matrix::Identity(columns, columns) * prior_variance;
    Matrix weights = Matrix::Zero(columns, outputs);
    Rows rows(static_cast<int>(columns));
    const Eigen::Map<const Eigen::Matrix<float, outputs, 1>> y(target);
    for ([[maybe_unused]] auto _ : state) {
        const Eigen::Map<const Eigen::VectorXf> row(rows.next(), columns);
        const Eigen::Matrix<float, outputs, 1> means = weights.transpose() * row;
        const Eigen::VectorXf gain = covariance * row;
        const float ratio = 1 + row.dot(gain);
        weights.noalias() += gain * ((y - means) / ratio).transpose();
        covariance.noalias() -= gain * (gain / ratio).transpose();
    }
}

void cos_sin_dfdyn(benchmark::State& state) {
    const auto count = static_cast<int>(state.range(0));
    std::vector<float> x(static_cast<std::size_t>(count), 1.5F);
    std::vector<float> c(x);
    std::vector<float> s(x);
    for ([[maybe_unused]] auto _ : state) {
        benchmark::DoNotOptimize(dfdyn::cos_sin(x.data(), count, 0.05F, c.data(), s.data()));
        benchmark::ClobberMemory();
    }
}

void cos_sin_library(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    std::vector<float> x(count, 1.5F);
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

void columns(benchmark::internal::Benchmark* benchmark) {
    benchmark->Arg(100)->Arg(200)->Arg(400)->Arg(500)->Arg(800)->Arg(1000)->Unit(benchmark::kMicrosecond);
}

} // namespace

BENCHMARK(learn<dfdyn::UdCovariance>)->Name("learn/dfdyn_UdCovariance")->Apply(columns);
BENCHMARK(learn<dfdyn::CholeskyInformation>)->Name("learn/dfdyn_CholeskyInformation")->Apply(columns);
BENCHMARK(eigen_rank_update)->Name("learn/eigen_LLT_rankUpdate_solve")->Apply(columns);
BENCHMARK(eigen_covariance)->Name("learn/eigen_covariance")->Apply(columns);
BENCHMARK(cos_sin_dfdyn)->Name("cos_sin/dfdyn")->Arg(400)->Unit(benchmark::kMicrosecond);
BENCHMARK(cos_sin_library)->Name("cos_sin/libm")->Arg(400)->Unit(benchmark::kMicrosecond);

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::AddCustomContext("build", dfdyn::tools::build_flags());
    benchmark::RunSpecifiedBenchmarks();
}
