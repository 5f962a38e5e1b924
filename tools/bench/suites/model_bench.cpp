// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/model_bench.hpp"

#include "dfdyn/features/random_fourier.hpp"
#include "dfdyn/learner/block_arrow.hpp"
#include "dfdyn/learner/ud_covariance.hpp"
#include "tools/bench/timing/whole_tick.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr int outputs = RegressionTask::outputs;
constexpr int inputs = RegressionTask::inputs;
constexpr int rows = 64;
constexpr float prior = 100;

template <class Storage>
void fill(Storage& storage, std::mt19937_64& engine, double deviation) {
    std::normal_distribution<double> normal(0, deviation);
    for (float& value : storage) {
        value = static_cast<float>(normal(engine));
    }
}

/// One sample of SPK: φ, the rows ψ, the targets.
template <int columns, int p>
struct Instant {
    Storage<float, columns> phi;
    Storage<float, outputs * p> psi;
    Storage<float, outputs> target;
};

template <int columns, int p>
std::vector<Instant<columns, p>> make_instants() {
    std::mt19937_64 engine(2);
    std::vector<Instant<columns, p>> instants(rows);
    for (auto& one : instants) {
        fill(one.phi, engine, 1 / std::sqrt(static_cast<double>(columns)));
        fill(one.psi, engine, 1);
        fill(one.target, engine, 5);
    }
    return instants;
}

template <int columns>
class Features final : public Ticking {
  public:
    Features() : xi_(rows) {
        std::mt19937_64 engine(3);
        fill(constants_.frequencies, engine, 0.25);
        constants_.amplitude = 1 / std::sqrt(static_cast<float>(columns) / 2);
        for (auto& xi : xi_) {
            fill(xi, engine, 1);
        }
    }
    void tick() override {
        next_ = (next_ + 1) % rows;
        keep(Map::template evaluate<float, inputs>(constants_, {}, {}, xi_[next_].data(), phi_.data()));
        keep(phi_);
    }

  private:
    using Map = RandomFourier<columns / 2>;
    typename Map::template Constants<float, inputs> constants_;
    Storage<float, columns> phi_;
    std::vector<Storage<float, inputs>> xi_;
    std::size_t next_ = 0;
};

template <int columns, int p>
class Nonparametric final : public Ticking {
  public:
    explicit Nonparametric(const std::vector<Instant<columns, p>>& instants) : instants_(instants) {}
    void tick() override {
        const auto& one = instants_[next_ = (next_ + 1) % rows];
        whole_tick(*learner_, one.target.data(), one.phi.data());
        keep(learner_->last_variance_ratio());
    }

  private:
    using Learner = UdCovariance<float, columns, outputs>;
    static constexpr typename Learner::Constants constants{prior, 1, nullptr};
    std::unique_ptr<Learner> learner_ =
        std::make_unique<Learner>(constants, Extent<columns>{}, Extent<outputs>{});
    const std::vector<Instant<columns, p>>& instants_;
    std::size_t next_ = 0;
};

template <int columns, int p>
class Kernel final : public Ticking {
  public:
    explicit Kernel(const std::vector<Instant<columns, p>>& instants) : instants_(instants) {}
    void tick() override {
        const auto& one = instants_[next_ = (next_ + 1) % rows];
        whole_tick(*learner_, one.target.data(), one.phi.data(), one.psi.data());
        float values[outputs];
        learner_->last_variance_ratios(values);
        keep(values);
    }
    Eigen::VectorXd predict(const Instant<columns, p>& one) {
        Eigen::Matrix<float, outputs, 1> means;
        learner_->predict(one.phi.data(), one.psi.data(), means.data());
        return means.template cast<double>();
    }

  private:
    using Learner = BlockArrow<float, columns, p, outputs>;
    static constexpr typename Learner::Constants constants{{prior, 1, nullptr}, {prior, 1, nullptr}};
    std::unique_ptr<Learner> learner_ =
        std::make_unique<Learner>(constants, Extent<columns>{}, Extent<p>{}, Extent<outputs>{});
    const std::vector<Instant<columns, p>>& instants_;
    std::size_t next_ = 0;
};

/// Least squares for all weights and parameters with one Cholesky factor of the information matrix: six rows
/// per tick, then the weights.
template <class Scalar, int columns, int p>
class Dense final : public Ticking {
  public:
    explicit Dense(const std::vector<Instant<columns, p>>& instants)
        : instants_(instants), factor_(Matrix(Matrix::Identity(unknowns, unknowns) / Scalar(prior))),
          right_(Vector::Zero(unknowns)), weights_(right_), row_(right_) {}
    void tick() override {
        const auto& one = instants_[next_ = (next_ + 1) % rows];
        keep(predict(one));
        for (int k = 0; k < outputs; ++k) {
            set_row(one, k);
            factor_.rankUpdate(row_, 1);
            right_ += row_ * static_cast<Scalar>(one.target[k]);
        }
        weights_ = factor_.solve(right_);
    }
    Eigen::VectorXd predict(const Instant<columns, p>& one) {
        Eigen::VectorXd means(outputs);
        for (int k = 0; k < outputs; ++k) {
            set_row(one, k);
            means[k] = static_cast<double>(row_.dot(weights_));
        }
        return means;
    }

  private:
    static constexpr int unknowns = outputs * columns + p;
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Floats = Eigen::Map<const Eigen::VectorXf>;

    void set_row(const Instant<columns, p>& one, int k) {
        row_.setZero();
        row_.segment(k * columns, columns) = Floats(one.phi.data(), columns).template cast<Scalar>();
        row_.tail(p) = Floats(one.psi.data() + k * p, p).template cast<Scalar>();
    }

    const std::vector<Instant<columns, p>>& instants_;
    Eigen::LLT<Matrix> factor_;
    Vector right_, weights_, row_;
    std::size_t next_ = 0;
};

/// Largest difference of the predictions for all samples after a few ticks of both, relative to their rms.
template <int columns, int p>
double kernel_error(const std::vector<Instant<columns, p>>& instants, int ticks) {
    Kernel<columns, p> kernel(instants);
    Dense<double, columns, p> dense(instants);
    for (int t = 0; t < ticks; ++t) {
        kernel.tick();
        dense.tick();
    }
    double worst = 0;
    double square = 0;
    for (const auto& one : instants) {
        const Eigen::VectorXd expected = dense.predict(one);
        worst = std::max(worst, (kernel.predict(one) - expected).cwiseAbs().maxCoeff());
        square += expected.squaredNorm();
    }
    return worst / std::sqrt(square / (rows * outputs));
}

template <int columns, int p>
ModelBench run(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe,
               const std::function<void(double)>& on_share_done) {
    const auto instants = make_instants<columns, p>();
    Nonparametric<columns, p> nonparametric(instants);
    const auto features = std::make_unique<Features<columns>>();
    Kernel<columns, p> kernel(instants);
    Dense<float, columns, p> dense(instants);
    ModelBench bench{columns, inputs, p, {}, {}, {}, {}, kernel_error(instants, dense_ticks)};
    Ticking* const ticking[] = {&nonparametric, features.get(), &kernel};
    const auto times = time_interleaved(ticking, options, probe, clock_cost_ns(), [&](int done) {
        on_share_done(static_cast<double>(done) / options.passes / 2);
    });
    bench.nonparametric = times[0];
    bench.features = times[1];
    bench.kernel = times[2];
    Ticking* const one[] = {&dense};
    RepetitionOptions few = options;
    few.passes = dense_ticks;
    few.fewest_ticks = 1;
    bench.dense = time_interleaved(one, few, probe, clock_cost_ns(), [&](int done) {
        on_share_done(0.5 + static_cast<double>(done) / dense_ticks / 2);
    })[0];
    return bench;
}

} // namespace

ModelBench run_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe,
                           const std::function<void(double)>& on_share_done) {
    return run<500, 52>(options, dense_ticks, probe, on_share_done);
}

ModelBench run_small_model_bench(const RepetitionOptions& options, int dense_ticks, MultiplyAddProbe& probe) {
    return run<20, 5>(options, dense_ticks, probe, [](double) {});
}

} // namespace dfdyn::tools
