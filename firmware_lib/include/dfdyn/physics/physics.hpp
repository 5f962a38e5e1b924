// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/checksum.hpp"
#include "dfdyn/input/input_identity.hpp"
#include "dfdyn/physics/effects.hpp"
#include "dfdyn/physics/rigid_body.hpp"

#include <algorithm>
#include <type_traits>

namespace dfdyn {

/// The parametric part of a model: columns ψ of the rigid body's inertial parameters and of named effects, so
/// that output = ψ π. `MotionType` is an input map whose `scale` makes (q, q̇, q̈) of each joint in rad, m
/// and s. All columns are ten per body, base to tip, then those of each effect in the order of the template
/// arguments. Of these, p are selected, because only certain combinations of inertial parameters are
/// identifiable.
template <class MotionType, int p, PhysicsEffect... EffectTypes>
struct Physics {
    static_assert(MotionType::features_per_joint == 3, "the motion is position, velocity and acceleration");
    using Motion = MotionType;
    static constexpr int columns = p;

    /// Constants of all effects, in the order of the template arguments. A reference to the constants of one
    /// effect binds to this object.
    template <class Scalar>
    struct EffectConstants : EffectTypes::template Constants<Scalar>... {};

    template <class Scalar, class Arm>
    struct Constants {
        typename Arm::template Constants<Scalar> chain;
        typename MotionType::template Constants<Scalar, Arm::joints> motion;
        [[no_unique_address]] EffectConstants<Scalar> effects;
        /// Limits of |q|, |q̇|, |q̈| of each joint (rad, m, s), beyond which no row is computed: one encoder
        /// glitch would otherwise outweigh all learned samples.
        Storage<Scalar, product(3, Arm::joints)> motion_limit;
        Storage<std::int32_t, p> selected;         ///< indices of the selected columns, ascending
        Storage<Scalar, p> column_scale;           ///< the learned parameter is the physical one / scale
        Storage<Scalar, Arm::outputs> output_gain; ///< output per N·m (N): 1, or 1 / torque constant (A/N·m)
    };

    /// Empty for a firmware model, where every size is a template argument.
    template <class Arm>
    struct Sizes {
        [[no_unique_address]] Extent<Arm::joints> joint_count{};
        [[no_unique_address]] Extent<Arm::outputs> output_count{};
        [[no_unique_address]] Extent<Arm::bodies> body_count{};
        [[no_unique_address]] Extent<MotionType::lags> lag_count{};
        [[no_unique_address]] Extent<p> column_count{};

        [[nodiscard]] constexpr typename Arm::Sizes chain() const noexcept {
            return {joint_count, output_count, body_count};
        }
    };

    /// Returns a number that differs between physics whose parameters have different meanings. It depends on
    /// the motion's input, the kind of outputs, the effects with columns, and the selected columns. O(p).
    template <class Scalar, class Arm>
    static std::uint32_t identity_of(const Constants<Scalar, Arm>& constants) noexcept {
        std::uint32_t crc = crc32_of(std::int32_t{input_identity<MotionType>(constants.motion)}, 0);
        crc = crc32_of(std::int32_t{Arm::Output::identity}, crc);
        (..., add_effect<EffectTypes, Scalar>(constants.effects, crc));
        for (const std::int32_t column : constants.selected) {
            crc = crc32_of(column, crc);
        }
        return crc;
    }

    /// Writes ψ (outputs × p, row-major, in the outputs' units) of a motion: (q, q̇, q̈) of each joint,
    /// element j of joint i at 3i + j; rad, m, s. The scalar may carry derivatives. Arguments are not
    /// checked. An effect with `at_joint` may be selected only if the outputs are joint torques; its rows are
    /// then joints of the arm.
    template <class Arm, class Real, class Scalar>
    static void evaluate_rows(const Constants<Real, Arm>& constants, const Sizes<Arm>& sizes,
                              const Scalar* xi, Scalar* psi) noexcept {
        constexpr bool torques = std::is_same_v<typename Arm::Output, JointTorques>;
        static_assert(torques || p == dynamic || !(false || ... || EffectTypes::at_joint),
                      "effects at joints need joint torques as outputs");
        [[maybe_unused]] int column = write_bodies(constants, sizes, xi, psi);
        [[maybe_unused]] int first = inertial_parameters * sizes.body_count;
        (..., write_effect<EffectTypes>(constants, sizes, xi, first, column, psi));
    }

    template <class Scalar, class Arm>
    class Map {
      public:
        using Constants = Physics::Constants<Scalar, Arm>;
        using Sizes = Physics::Sizes<Arm>;

        Map(const Constants& constants, const Sizes& sizes) noexcept
            : constants_(&constants), sizes_(sizes),
              motion_(constants.motion, sizes.joint_count, sizes.lag_count, {}),
              xi_(Inputs::zeros(extent<inputs>(3 * sizes.joint_count))) {}

        void restart() noexcept { motion_.restart(); }
        [[nodiscard]] bool ready() const noexcept { return motion_.ready(); }

        template <class AnySample>
        void push(const AnySample& sample) noexcept {
            motion_.push(sample);
        }

        /// Writes ψ (outputs × p, row-major, in the outputs' units) of the newest sample. Returns false, with
        /// ψ undefined, if its motion exceeds the limits or is NaN.
        bool evaluate(Scalar* psi) noexcept {
            motion_.evaluate(xi_.data());
            for (int i = 0; i < 3 * sizes_.joint_count; ++i) {
                if (!(std::abs(xi_[i]) <= constants_->motion_limit[i])) {
                    return false;
                }
            }
            evaluate_rows(*constants_, sizes_, xi_.data(), psi);
            return true;
        }

        /// Returns the maximum multiply-adds of `evaluate`, reached if every column is selected.
        [[nodiscard]] static constexpr std::int64_t cost(const Sizes& sizes) noexcept {
            const std::int64_t written = std::int64_t{2} * sizes.output_count * sizes.column_count;
            return MotionMap::cost(sizes.joint_count, sizes.lag_count, 3) +
                   rigid_body_cost<Arm, Scalar>(sizes.chain()) + written + effects_cost(sizes.column_count);
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(const Sizes& sizes) noexcept {
            return MotionMap::state_bytes(sizes.joint_count, sizes.lag_count, 3) +
                   storage_bytes<Scalar>(std::int64_t{3} * sizes.joint_count);
        }

        /// Returns the maximum stack bytes of `push` and `evaluate`: the outputs' screws, motion and frame of
        /// a link, the row of a body, and the computation of the next link with its cosine and sine.
        [[nodiscard]] static constexpr std::int64_t stack_bytes(const Sizes& sizes) noexcept {
            constexpr int of_a_link = 224;
            const std::int64_t scalars = of_a_link + 6 * sizes.output_count;
            return std::max(MotionMap::stack_bytes(), frame_bytes + scalars * std::int64_t{sizeof(Scalar)});
        }

      private:
        template <class Effect>
        static constexpr std::int64_t effect_cost(int selected) noexcept {
            const int most = Effect::columns == dynamic ? selected : std::min(Effect::columns, selected);
            return Effect::template column_cost<Scalar> * most;
        }
        /// Returns the cost of the effects: the sum over all columns, but at most `selected` times the cost
        /// of the most expensive column.
        static constexpr std::int64_t effects_cost(int selected) noexcept {
            const std::int64_t most =
                std::max({std::int64_t{0}, EffectTypes::template column_cost<Scalar>...});
            return std::min(most * selected, (std::int64_t{0} + ... + effect_cost<EffectTypes>(selected)));
        }

        static constexpr int inputs = product(3, Arm::joints);
        using MotionMap = typename MotionType::template Map<Scalar, Arm::joints>;
        using Inputs = Storage<Scalar, inputs>;

        const Constants* constants_;
        [[no_unique_address]] Sizes sizes_;
        MotionMap motion_;
        Inputs xi_;
    };

  private:
    /// Adds an effect to a checksum unless it has no columns: the physics of a host program contains all
    /// effects.
    template <class Effect, class Scalar>
    static void add_effect(const typename Effect::template Constants<Scalar>& effect,
                           std::uint32_t& crc) noexcept {
        if (effect.row.size() > 0) {
            crc = crc32_of(std::int32_t{Effect::identity}, crc);
            crc = crc32_of(std::int32_t{effect.row.size()}, crc);
        }
    }

    /// Writes the selected columns of all bodies; returns their number.
    template <class Arm, class Real, class Scalar>
    static int write_bodies(const Constants<Real, Arm>& constants, const Sizes<Arm>& sizes, const Scalar* xi,
                            Scalar* psi) noexcept {
        int column = 0;
        const auto write = [&](int body, const LinkMotion<Scalar>& motion, const Screw<Scalar>* screws,
                               int count) {
            const int first = column;
            column = end_of(constants, sizes, column, inertial_parameters * (body + 1));
            for (int k = 0; k < sizes.output_count && column > first; ++k) {
                Scalar row[inertial_parameters];
                if (k < count) {
                    inertial_row(screws[k], motion, row);
                }
                for (int c = first; c < column; ++c) {
                    const int parameter = constants.selected[c] - inertial_parameters * body;
                    put(constants, sizes, k, c, k < count ? row[parameter] : Scalar(0), psi);
                }
            }
        };
        for_each_body<Arm, Real>(constants.chain, sizes.chain(), xi, write);
        return column;
    }

    /// Writes the selected columns of one effect, whose first column has index `first`; advances both
    /// indices.
    template <class Effect, class Arm, class Real, class Scalar>
    static void write_effect(const Constants<Real, Arm>& constants, const Sizes<Arm>& sizes, const Scalar* xi,
                             int& first, int& column, Scalar* psi) noexcept {
        const typename Effect::template Constants<Real>& effect = constants.effects;
        const int last = end_of(constants, sizes, column, first + effect.row.size());
        for (; column < last; ++column) {
            const int own = constants.selected[column] - first;
            for (int k = 0; k < sizes.output_count; ++k) {
                put(constants, sizes, k, column,
                    k == effect.row[own] ? Effect::value(effect, own, xi) : Scalar(0), psi);
            }
        }
        first += effect.row.size();
    }

    /// Returns the first selected column, from `column` on, whose index is at least `index`.
    template <class Arm, class Real>
    static int end_of(const Constants<Real, Arm>& constants, const Sizes<Arm>& sizes, int column,
                      int index) noexcept {
        while (column < sizes.column_count && constants.selected[column] < index) {
            ++column;
        }
        return column;
    }

    template <class Arm, class Real, class Scalar>
    static void put(const Constants<Real, Arm>& constants, const Sizes<Arm>& sizes, int output, int column,
                    const Scalar& value, Scalar* psi) noexcept {
        psi[output * sizes.column_count + column] =
            value * (constants.output_gain[output] * constants.column_scale[column]);
    }
};

} // namespace dfdyn
