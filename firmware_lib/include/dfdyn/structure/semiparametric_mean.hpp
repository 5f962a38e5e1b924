// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/structure/nonparametric.hpp"
#include "dfdyn/structure/physics_columns.hpp"

#include <algorithm>

namespace dfdyn {

/// Constants of a model whose physics is its mean.
template <class Scalar, int parameters, class LearnerConstantsType>
struct MeanConstants {
    Storage<Scalar, parameters> parameters_of_mean; ///< π, per unit of the physics' column scale
    LearnerConstantsType residual;                  ///< of the learner of what the mean leaves
    static constexpr std::int64_t start_bytes = LearnerConstantsType::start_bytes;
};

/// Models SP and SP2 of the paper (eq. eq:SP-Mean_model_statistics): y_k = ψ_k'π + φ'w_k + e with a fixed π;
/// the two differ in how training finds it. See `Nonparametric` for what a structure is.
template <class PhysicsType,
          template <class Scalar, int columns, int outputs> class LearnerForm = UdCovariance>
struct SemiparametricMean {
    using Physics = PhysicsType;
    static constexpr int identity = 3;

    template <class Scalar, int columns, int outputs>
    using Constants =
        MeanConstants<Scalar, Physics::columns, typename LearnerForm<Scalar, columns, outputs>::Constants>;

    template <class Model>
    class Regression : public Nonparametric<LearnerForm>::template Regression<Model> {
        using Residual = typename Nonparametric<LearnerForm>::template Regression<Model>;

      public:
        using Scalar = typename Model::Scalar;

        explicit Regression(const typename Model::Constants& constants) noexcept
            : Residual(constants, constants.learner.residual), constants_(&constants), physics_(constants),
              mean_(Outputs::zeros(constants.sizes.output_count)), target_(mean_) {}

        void restart() noexcept {
            Residual::restart();
            physics_.restart();
        }
        [[nodiscard]] bool ready() const noexcept { return Residual::ready() && physics_.ready(); }
        void push(const typename Model::Sample& sample) noexcept {
            Residual::push(sample);
            physics_.push(sample);
        }

        bool evaluate() noexcept {
            if (!Residual::evaluate() || !physics_.evaluate()) {
                return false;
            }
            const int parameters = constants_->sizes.physics.column_count;
            for (int k = 0; k < constants_->sizes.output_count; ++k) {
                mean_[k] = detail::dot(physics_.data() + k * parameters,
                                       constants_->learner.parameters_of_mean.data(), parameters);
            }
            return true;
        }

        void predict(Scalar* means) noexcept {
            Residual::predict(means);
            add_mean(means);
        }
        void predict_without_features(Scalar* means) const noexcept {
            for (int k = 0; k < constants_->sizes.output_count; ++k) {
                means[k] = mean_[k];
            }
        }
        void predict_with(const Scalar* weights, Scalar* means) const noexcept {
            Residual::predict_with(weights, means);
            add_mean(means);
        }
        void begin(const Scalar* targets, Scalar noise_variance) noexcept {
            for (int k = 0; k < constants_->sizes.output_count; ++k) {
                target_[k] = targets[k] - mean_[k];
            }
            Residual::begin(target_.data(), noise_variance);
        }

        /// ψ of the last tick that predicted, m × p.
        [[nodiscard]] const Scalar* physics() const noexcept { return physics_.data(); }

        [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes) noexcept {
            Cost cost = Residual::cost(sizes);
            cost.predict += PhysicsColumns<Model>::cost(sizes) +
                            std::int64_t{sizes.output_count} * sizes.physics.column_count;
            return cost;
        }

        /// Of any call.
        [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
            return std::max(Residual::stack_bytes(sizes), PhysicsColumns<Model>::stack_bytes(sizes));
        }

      private:
        using Outputs = Storage<Scalar, Model::outputs>;

        void add_mean(Scalar* means) const noexcept {
            for (int k = 0; k < constants_->sizes.output_count; ++k) {
                means[k] += mean_[k];
            }
        }

        const typename Model::Constants* constants_;
        PhysicsColumns<Model> physics_;
        Outputs mean_; ///< ψ_k'π at the present columns
        Outputs target_;
    };
};

} // namespace dfdyn
