// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/block_arrow.hpp"
#include "dfdyn/structure/feature_columns.hpp"
#include "dfdyn/structure/physics_columns.hpp"

#include <algorithm>

namespace dfdyn {

/// Model SPK (paper, Section III-D, eq. 8): y_k = ψ_k'π + φ'w_k + e, where the parameters π of the physics
/// are learned together with the weights of the features. `Nonparametric` documents what a structure is.
template <class PhysicsType>
struct SemiparametricKernel {
    using Physics = PhysicsType;
    static constexpr int identity = 4;

    template <class Scalar, int columns, int outputs>
    using Constants = BlockArrowConstants<Scalar, columns, Physics::columns, outputs>;

    /// φ and ψ; see `ColumnsOf`.
    template <class Model>
    class Columns {
      public:
        using Scalar = typename Model::Scalar;
        static constexpr int weights = sum(product(Model::outputs, Model::columns), Model::parameters);

        explicit Columns(const typename Model::Constants& constants) noexcept
            : features_(constants), physics_(constants) {}

        void restart() noexcept {
            features_.restart();
            physics_.restart();
        }
        [[nodiscard]] bool ready() const noexcept { return features_.ready() && physics_.ready(); }
        void push(const typename Model::Sample& sample) noexcept {
            features_.push(sample);
            physics_.push(sample);
        }
        bool evaluate() noexcept { return features_.evaluate() && physics_.evaluate(); }

        /// Returns φ (2d values); `physics` returns ψ (m × p). Both of the last `evaluate`.
        [[nodiscard]] const Scalar* features() const noexcept { return features_.data(); }
        [[nodiscard]] const Scalar* physics() const noexcept { return physics_.data(); }

        /// Predicts m `means`. `numbers`: weights w of all outputs, m × 2d, then π, p values. O(m (2d + p)).
        void predict_with(const Scalar* numbers, Scalar* means) const noexcept {
            const typename Model::Sizes& sizes = features_.sizes();
            const int columns = sizes.column_count();
            const int parameters = sizes.physics.column_count;
            const Scalar* const of_physics = numbers + sizes.output_count * columns;
            for (int k = 0; k < sizes.output_count; ++k) {
                means[k] = detail::dot(numbers + k * columns, features(), columns) +
                           detail::dot(of_physics, physics() + k * parameters, parameters);
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(const typename Model::Sizes& sizes) noexcept {
            return FeatureColumns<Model>::cost(sizes) + PhysicsColumns<Model>::cost(sizes);
        }

        [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
            return std::max(FeatureColumns<Model>::stack_bytes(), PhysicsColumns<Model>::stack_bytes(sizes));
        }

      private:
        FeatureColumns<Model> features_;
        PhysicsColumns<Model> physics_;
    };

    template <class Model>
    class Regression {
      public:
        using Scalar = typename Model::Scalar;
        using Learner = BlockArrow<Scalar, Model::columns, Model::parameters, Model::outputs>;

        explicit Regression(const typename Model::Constants& constants) noexcept
            : outputs_(constants.sizes.output_count), column_count_(constants.sizes.column_count()),
              parameters_(constants.sizes.physics.column_count), columns_(constants),
              learner_(constants.learner, constants.sizes.column_count(),
                       constants.sizes.physics.column_count, constants.sizes.output_count) {}

        void reset() noexcept { learner_.reset(); }
        void restart() noexcept { columns_.restart(); }
        [[nodiscard]] bool ready() const noexcept { return columns_.ready(); }
        void push(const typename Model::Sample& sample) noexcept { columns_.push(sample); }
        bool evaluate() noexcept { return columns_.evaluate(); }

        void predict(Scalar* means) noexcept {
            learner_.predict(columns_.features(), columns_.physics(), means);
        }
        void predict_without_features(Scalar* means) const noexcept {
            learner_.common().predict(columns_.physics(), means);
        }
        Scalar variances(Scalar* ratios) const noexcept {
            const Scalar of_features = learner_.variances(columns_.features(), ratios);
            for (int k = 0; k < outputs_; ++k) {
                ratios[k] += 1;
            }
            return of_features;
        }
        Scalar last_variance_ratios(Scalar* ratios) const noexcept {
            return learner_.last_variance_ratios(ratios);
        }

        [[nodiscard]] bool idle() const noexcept { return learner_.idle(); }
        [[nodiscard]] bool sample_pending() const noexcept { return learner_.sample_pending(); }
        void begin(const Scalar* targets, Scalar noise_variance) noexcept {
            learner_.begin(columns_.features(), columns_.physics(), targets, noise_variance);
        }
        void reset_covariance() noexcept { learner_.reset_covariance(); }
        bool advance(Budget& budget) noexcept { return learner_.advance(budget); }

        [[nodiscard]] const Learner& learner() const noexcept { return learner_; }
        [[nodiscard]] const Scalar* columns() const noexcept { return columns_.features(); }
        [[nodiscard]] const Scalar* physics() const noexcept { return columns_.physics(); }

        /// Returns the number of weights: E[w] of all outputs, then π.
        [[nodiscard]] int weight_count() const noexcept { return outputs_ * column_count_ + parameters_; }
        void copy_weights(Scalar* weights) const noexcept {
            learner_.copy_weights(weights);
            for (int c = 0; c < parameters_; ++c) {
                weights[outputs_ * column_count_ + c] = learner_.common().parameters()[c];
            }
        }
        void predict_with(const Scalar* weights, Scalar* means) const noexcept {
            columns_.predict_with(weights, means);
        }

        [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes) noexcept {
            Cost cost = Learner::cost(sizes.column_count(), sizes.physics.column_count, sizes.output_count);
            cost.predict +=
                Columns<Model>::cost(sizes) + std::int64_t{sizes.output_count} * sizes.physics.column_count;
            return cost;
        }

        /// Returns the maximum stack bytes over all calls.
        [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
            return std::max(Learner::stack_bytes(), Columns<Model>::stack_bytes(sizes));
        }

        template <class Self, class Visitor>
        static void visit_state(Self& self, Visitor& visitor) noexcept {
            Learner::visit_state(self.learner_, visitor);
        }

      private:
        [[no_unique_address]] Extent<Model::outputs> outputs_;
        [[no_unique_address]] Extent<Model::columns> column_count_;
        [[no_unique_address]] Extent<Model::parameters> parameters_;
        Columns<Model> columns_;
        Learner learner_;
    };
};

} // namespace dfdyn
