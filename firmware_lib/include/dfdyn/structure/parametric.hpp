// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/common_parameters.hpp"
#include "dfdyn/structure/null_components.hpp"
#include "dfdyn/structure/physics_columns.hpp"

#include <algorithm>

namespace dfdyn {

/// Model P (paper, Section III-A, eq. 3): y_k = ψ_k'π + e, with the parameters of the rigid body and of named
/// effects, common to all outputs. Use `NoInput` and `NoFeatures` as the model's input and features.
/// `Nonparametric` documents what a structure is.
template <class PhysicsType>
struct Parametric {
    using Physics = PhysicsType;
    static constexpr int identity = 2;

    template <class Scalar, int columns, int outputs>
    using Constants = LearnerConstants<Scalar, Physics::columns, 1>;

    /// See `ColumnsOf`.
    template <class Model>
    class Columns : public PhysicsColumns<Model> {
      public:
        static constexpr int weights = Model::parameters;

        explicit Columns(const typename Model::Constants& constants) noexcept
            : PhysicsColumns<Model>(constants) {}

        /// Predicts m `means`. `numbers`: parameters π, p values. O(m p).
        void predict_with(const typename Model::Scalar* numbers,
                          typename Model::Scalar* means) const noexcept {
            const int count = this->sizes().physics.column_count;
            for (int k = 0; k < this->sizes().output_count; ++k) {
                means[k] = detail::dot(this->data() + k * count, numbers, count);
            }
        }
    };

    template <class Model>
    class Regression {
      public:
        using Scalar = typename Model::Scalar;
        using Learner = CommonParameters<Scalar, Model::parameters, Model::outputs>;

        explicit Regression(const typename Model::Constants& constants) noexcept
            : outputs_(constants.sizes.output_count), parameters_(constants.sizes.physics.column_count),
              physics_(constants), learner_(constants.learner, constants.sizes.physics.column_count,
                                            constants.sizes.output_count) {}

        void reset() noexcept { learner_.reset(); }
        void restart() noexcept { physics_.restart(); }
        [[nodiscard]] bool ready() const noexcept { return physics_.ready(); }
        void push(const typename Model::Sample& sample) noexcept { physics_.push(sample); }
        bool evaluate() noexcept { return physics_.evaluate(); }

        void predict(Scalar* means) noexcept { learner_.predict(physics_.data(), means); }
        void predict_without_features(Scalar* means) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                means[k] = 0; // no effect: without features no part of a prediction is reduced
            }
        }
        Scalar variances(Scalar* ratios) const noexcept {
            learner_.variances(physics_.data(), ratios);
            add_noise(ratios);
            return 0;
        }
        Scalar last_variance_ratios(Scalar* ratios) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                ratios[k] = learner_.last_variances()[k];
            }
            add_noise(ratios);
            return 0;
        }

        [[nodiscard]] bool idle() const noexcept { return learner_.idle(); }
        [[nodiscard]] bool sample_pending() const noexcept { return learner_.sample_pending(); }
        void begin(const Scalar* targets, Scalar noise_variance) noexcept {
            learner_.begin(physics_.data(), targets, noise_variance);
        }
        void reset_covariance() noexcept { learner_.reset_covariance(); }
        bool advance(Budget& budget) noexcept { return learner_.advance(budget); }

        [[nodiscard]] const Learner& learner() const noexcept { return learner_; }
        /// Returns ψ of the last tick that predicted, m × p.
        [[nodiscard]] const Scalar* physics() const noexcept { return physics_.data(); }

        [[nodiscard]] int weight_count() const noexcept { return parameters_; }
        void copy_weights(Scalar* weights) const noexcept {
            for (int c = 0; c < parameters_; ++c) {
                weights[c] = learner_.parameters()[c];
            }
        }
        void predict_with(const Scalar* weights, Scalar* means) const noexcept {
            physics_.predict_with(weights, means);
        }

        [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes) noexcept {
            Cost cost = Learner::cost(sizes.physics.column_count, sizes.output_count);
            cost.predict += PhysicsColumns<Model>::cost(sizes);
            return cost;
        }

        /// Returns the maximum stack bytes over all calls.
        [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
            return std::max(Learner::stack_bytes(), PhysicsColumns<Model>::stack_bytes(sizes));
        }

        template <class Self, class Visitor>
        static void visit_state(Self& self, Visitor& visitor) noexcept {
            Learner::visit_state(self.learner_, visitor);
        }

      private:
        void add_noise(Scalar* ratios) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                ratios[k] += 1;
            }
        }

        [[no_unique_address]] Extent<Model::outputs> outputs_;
        [[no_unique_address]] Extent<Model::parameters> parameters_;
        Columns<Model> physics_;
        Learner learner_;
    };
};

} // namespace dfdyn
