// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"
#include "dfdyn/structure/feature_columns.hpp"
#include "dfdyn/structure/null_components.hpp"

#include <algorithm>

namespace dfdyn {

/// Model NP (paper, Section III-B, eq. 4): the columns are the features alone, common to all outputs, with
/// one learner.
///
/// A structure is a type that defines `Physics` (`NoPhysics` if none), the `Constants` of its learner, its
/// `Columns` (see `ColumnsOf`), a `Regression` (see `RegressionOf`), and an `identity` that is unique among
/// the structures.
template <template <class Scalar, int columns, int outputs> class LearnerForm = UdCovariance>
struct Nonparametric {
    using Physics = NoPhysics;
    static constexpr int identity = 1;

    template <class Scalar, int columns, int outputs>
    using Constants = typename LearnerForm<Scalar, columns, outputs>::Constants;

    /// See `ColumnsOf`.
    template <class Model>
    class Columns : public FeatureColumns<Model> {
      public:
        static constexpr int weights = product(Model::outputs, Model::columns);

        explicit Columns(const typename Model::Constants& constants) noexcept
            : FeatureColumns<Model>(constants) {}

        /// Predicts m `means`. `numbers`: weights w of all outputs, m × 2d. O(2d m).
        void predict_with(const typename Model::Scalar* numbers,
                          typename Model::Scalar* means) const noexcept {
            const int count = this->sizes().column_count();
            for (int k = 0; k < this->sizes().output_count; ++k) {
                means[k] = detail::dot(numbers + k * count, this->data(), count);
            }
        }
    };

    template <class Model>
    class Regression {
      public:
        using Scalar = typename Model::Scalar;
        using Learner = LearnerForm<Scalar, Model::columns, Model::outputs>;
        static_assert(dfdyn::Learner<Learner, Scalar>);

        explicit Regression(const typename Model::Constants& constants) noexcept
            : Regression(constants, constants.learner) {}

        Regression(const typename Model::Constants& constants,
                   const typename Learner::Constants& learner) noexcept
            : outputs_(constants.sizes.output_count), column_count_(constants.sizes.column_count()),
              columns_(constants),
              learner_(learner, constants.sizes.column_count(), constants.sizes.output_count) {}

        void reset() noexcept { learner_.reset(); }
        void restart() noexcept { columns_.restart(); }
        [[nodiscard]] bool ready() const noexcept { return columns_.ready(); }
        void push(const typename Model::Sample& sample) noexcept { columns_.push(sample); }
        bool evaluate() noexcept { return columns_.evaluate(); }

        void predict(Scalar* means) noexcept { learner_.predict(columns_.data(), means); }
        void predict_without_features(Scalar* means) const noexcept { fill(0, means); }
        Scalar variances(Scalar* ratios) const noexcept {
            const Scalar ratio = 1 + learner_.variance(columns_.data());
            fill(ratio, ratios);
            return ratio - 1;
        }
        Scalar last_variance_ratios(Scalar* ratios) const noexcept {
            fill(learner_.last_variance_ratio(), ratios);
            return learner_.last_variance_ratio() - 1;
        }

        [[nodiscard]] bool idle() const noexcept { return learner_.idle(); }
        [[nodiscard]] bool sample_pending() const noexcept { return learner_.sample_pending(); }
        void begin(const Scalar* targets, Scalar noise_variance) noexcept {
            learner_.begin(columns_.data(), targets, noise_variance);
        }
        void reset_covariance() noexcept { learner_.reset_covariance(); }
        bool advance(Budget& budget) noexcept { return learner_.advance(budget); }

        [[nodiscard]] const Learner& learner() const noexcept { return learner_; }
        /// Returns φ of the last tick that predicted, 2d values.
        [[nodiscard]] const Scalar* columns() const noexcept { return columns_.data(); }

        [[nodiscard]] int weight_count() const noexcept { return outputs_ * column_count_; }
        void copy_weights(Scalar* weights) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                for (int j = 0; j < column_count_; ++j) {
                    weights[k * column_count_ + j] = learner_.weights(k)[j];
                }
            }
        }
        void predict_with(const Scalar* weights, Scalar* means) const noexcept {
            columns_.predict_with(weights, means);
        }

        [[nodiscard]] static constexpr Cost cost(const typename Model::Sizes& sizes) noexcept {
            Cost cost = Learner::cost(sizes.column_count(), sizes.output_count);
            cost.predict += FeatureColumns<Model>::cost(sizes);
            return cost;
        }

        /// Returns the maximum stack bytes over all calls.
        [[nodiscard]] static constexpr std::int64_t
        stack_bytes(const typename Model::Sizes& /*sizes*/) noexcept {
            return std::max(Learner::stack_bytes(), FeatureColumns<Model>::stack_bytes());
        }

        template <class Self, class Visitor>
        static void visit_state(Self& self, Visitor& visitor) noexcept {
            Learner::visit_state(self.learner_, visitor);
        }

      private:
        void fill(Scalar value, Scalar* values) const noexcept {
            for (int k = 0; k < outputs_; ++k) {
                values[k] = value;
            }
        }

        [[no_unique_address]] Extent<Model::outputs> outputs_;
        [[no_unique_address]] Extent<Model::columns> column_count_;
        Columns<Model> columns_;
        Learner learner_;
    };
};

} // namespace dfdyn
