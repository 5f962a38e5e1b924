// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/structure/nonparametric.hpp"
#include "dfdyn/structure/physics_columns.hpp"

#include <algorithm>

namespace dfdyn {

/// Constants of a model with the physics as its mean.
template <class Scalar, int parameters, class LearnerConstantsType>
struct MeanConstants {
    Storage<Scalar, parameters> parameters_of_mean; ///< π, per unit of the physics' column scale
    LearnerConstantsType residual;                  ///< of the learner of the residual
    static constexpr std::int64_t start_bytes = LearnerConstantsType::start_bytes;
};

/// Predicts ψ_k'π of each output at the present columns, with a fixed π.
template <class Model>
class FixedMean {
  public:
    using Scalar = typename Model::Scalar;

    explicit FixedMean(const typename Model::Constants& constants) noexcept
        : constants_(&constants), physics_(constants), mean_(Outputs::zeros(constants.sizes.output_count)) {}

    void restart() noexcept { physics_.restart(); }
    [[nodiscard]] bool ready() const noexcept { return physics_.ready(); }
    void push(const typename Model::Sample& sample) noexcept { physics_.push(sample); }

    /// Computes ψ_k'π of each output. Returns false if the columns of the physics are not usable.
    bool evaluate() noexcept {
        if (!physics_.evaluate()) {
            return false;
        }
        const int parameters = constants_->sizes.physics.column_count;
        for (int k = 0; k < constants_->sizes.output_count; ++k) {
            mean_[k] = detail::dot(physics_.data() + k * parameters,
                                   constants_->learner.parameters_of_mean.data(), parameters);
        }
        return true;
    }

    [[nodiscard]] Scalar operator[](int output) const noexcept { return mean_[output]; }
    void add_to(Scalar* means) const noexcept {
        for (int k = 0; k < constants_->sizes.output_count; ++k) {
            means[k] += mean_[k];
        }
    }

    /// Returns ψ of the last `evaluate`, m × p.
    [[nodiscard]] const Scalar* physics() const noexcept { return physics_.data(); }

    [[nodiscard]] static constexpr std::int64_t cost(const typename Model::Sizes& sizes) noexcept {
        return PhysicsColumns<Model>::cost(sizes) +
               std::int64_t{sizes.output_count} * sizes.physics.column_count;
    }

  private:
    using Outputs = Storage<Scalar, Model::outputs>;

    const typename Model::Constants* constants_;
    PhysicsColumns<Model> physics_;
    Outputs mean_;
};

/// Models SP and SP2 (paper, Section III-C, eq. 7): y_k = ψ_k'π + φ'w_k + e with a fixed π. The two differ in
/// how training estimates π. `Nonparametric` documents what a structure is.
template <class PhysicsType,
          template <class Scalar, int columns, int outputs> class LearnerForm = UdCovariance>
struct SemiparametricMean {
    using Physics = PhysicsType;
    static constexpr int identity = 3;

    template <class Scalar, int columns, int outputs>
    using Constants =
        MeanConstants<Scalar, Physics::columns, typename LearnerForm<Scalar, columns, outputs>::Constants>;

    /// φ and the mean; see `ColumnsOf`.
    template <class Model>
    class Columns : public Nonparametric<LearnerForm>::template Columns<Model> {
        using Features = typename Nonparametric<LearnerForm>::template Columns<Model>;

      public:
        explicit Columns(const typename Model::Constants& constants) noexcept
            : Features(constants), mean_(constants) {}

        void restart() noexcept {
            Features::restart();
            mean_.restart();
        }
        [[nodiscard]] bool ready() const noexcept { return Features::ready() && mean_.ready(); }
        void push(const typename Model::Sample& sample) noexcept {
            Features::push(sample);
            mean_.push(sample);
        }
        bool evaluate() noexcept { return Features::evaluate() && mean_.evaluate(); }

        /// Predicts m `means`. `numbers`: weights w of all outputs, m × 2d. O(2d m).
        void predict_with(const typename Model::Scalar* numbers,
                          typename Model::Scalar* means) const noexcept {
            Features::predict_with(numbers, means);
            mean_.add_to(means);
        }

        [[nodiscard]] static constexpr std::int64_t cost(const typename Model::Sizes& sizes) noexcept {
            return Features::cost(sizes) + FixedMean<Model>::cost(sizes);
        }

      private:
        FixedMean<Model> mean_;
    };

    template <class Model>
    class Regression : public Nonparametric<LearnerForm>::template Regression<Model> {
        using Residual = typename Nonparametric<LearnerForm>::template Regression<Model>;

      public:
        using Scalar = typename Model::Scalar;

        explicit Regression(const typename Model::Constants& constants) noexcept
            : Residual(constants, constants.learner.residual), outputs_(constants.sizes.output_count),
              mean_(constants), target_(Outputs::zeros(constants.sizes.output_count)) {}

        void restart() noexcept {
            Residual::restart();
            mean_.restart();
        }
        [[nodiscard]] bool ready() const noexcept { return Residual::ready() && mean_.ready(); }
        void push(const typename Model::Sample& sample) noexcept {
            Residual::push(sample);
            mean_.push(sample);
        }
        bool evaluate() noexcept { return Residual::evaluate() && mean_.evaluate(); }

        void predict(Scalar* means) noexcept {
            Residual::predict(means);
            mean_.add_to(means);
        }
        void predict_without_features(Scalar* means) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                means[k] = mean_[k];
            }
        }
        void predict_with(const Scalar* weights, Scalar* means) const noexcept {
            Residual::predict_with(weights, means);
            mean_.add_to(means);
        }
        void begin(const Scalar* targets, Scalar noise_variance) noexcept {
            for (int k = 0; k < outputs_; ++k) {
                target_[k] = targets[k] - mean_[k];
            }
            Residual::begin(target_.data(), noise_variance);
        }

        /// Returns ψ of the last tick that predicted, m × p.
        [[nodiscard]] const Scalar* physics() const noexcept { return mean_.physics(); }

        [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes) noexcept {
            Cost cost = Residual::cost(sizes);
            cost.predict += FixedMean<Model>::cost(sizes);
            return cost;
        }

        /// Returns the maximum stack bytes over all calls.
        [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
            return std::max(Residual::stack_bytes(sizes), PhysicsColumns<Model>::stack_bytes(sizes));
        }

      private:
        using Outputs = Storage<Scalar, Model::outputs>;

        [[no_unique_address]] Extent<Model::outputs> outputs_;
        FixedMean<Model> mean_;
        Outputs target_;
    };
};

} // namespace dfdyn
