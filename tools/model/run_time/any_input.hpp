// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/input/derivative_free.hpp"
#include "dfdyn/input/derivative_free_reduced.hpp"
#include "dfdyn/input/standard.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <variant>

namespace dfdyn::tools {

/// An input map of the firmware whose kind is chosen at run time. Its arithmetic is the kind's own. DFW
/// runs as DF (its weights are part of the scale), and DFSR as DFR (with its rows).
template <int k>
struct AnyInput {
    static constexpr int lags = dynamic;
    static constexpr int features_per_joint = k;
    template <class Scalar, int n, int m>
    using Sample = SampleWithDerivatives<Scalar, n, m>;

    template <class Scalar, int n>
    using Constants = std::variant<typename Standard<dynamic>::template Constants<Scalar, n>,
                                   typename StandardMeasured::template Constants<Scalar, n>,
                                   typename DerivativeFree<dynamic>::template Constants<Scalar, n>,
                                   typename DerivativeFreeReduced<dynamic, k>::template Constants<Scalar, n>>;

    /// Identity of the active kind.
    template <class AnyConstants>
    static constexpr int identity_of(const AnyConstants& constants) noexcept {
        constexpr int identities[] = {Standard<dynamic>::identity, StandardMeasured::identity,
                                      DerivativeFree<dynamic>::identity,
                                      DerivativeFreeReduced<dynamic, k>::identity};
        return identities[constants.index()];
    }

    template <class Scalar, int n>
    class Map {
      public:
        Map(const Constants<Scalar, n>& constants, Extent<n> joints, Extent<dynamic> lag_count,
            Extent<k> rows)
            : map_(apply([&](const auto& own) { return make(own, joints, lag_count, rows); }, constants)) {}

        void restart() noexcept {
            apply([](auto& map) { map.restart(); }, map_);
        }
        [[nodiscard]] bool ready() const noexcept {
            return apply([](const auto& map) { return map.ready(); }, map_);
        }
        template <class AnySample>
        void push(const AnySample& sample) noexcept {
            apply([&](auto& map) { map.push(sample); }, map_);
        }
        void evaluate(Scalar* xi) const noexcept {
            apply([&](const auto& map) { map.evaluate(xi); }, map_);
        }

        /// Returns 0: the cost depends on the kind, see `cost_of_input`.
        [[nodiscard]] static constexpr std::int64_t cost(int /*joints*/, int /*lags*/, int /*rows*/) {
            return 0;
        }

      private:
        /// Like std::visit, without its exception: a variant of these types always has a value.
        template <class Visitor, class Variant>
        static auto apply(const Visitor& visitor, Variant& variant) noexcept {
            if (auto* const first = std::get_if<0>(&variant)) {
                return visitor(*first);
            }
            if (auto* const second = std::get_if<1>(&variant)) {
                return visitor(*second);
            }
            if (auto* const third = std::get_if<2>(&variant)) {
                return visitor(*third);
            }
            return visitor(*std::get_if<3>(&variant));
        }

        template <class Input>
        using MapOf = typename Input::template Map<Scalar, n>;
        using AnyMap = std::variant<MapOf<Standard<dynamic>>, MapOf<StandardMeasured>,
                                    MapOf<DerivativeFree<dynamic>>, MapOf<DerivativeFreeReduced<dynamic, k>>>;

        using OfStandard = typename Standard<dynamic>::template Constants<Scalar, n>;
        using OfMeasured = typename StandardMeasured::template Constants<Scalar, n>;
        using OfWindow = typename DerivativeFree<dynamic>::template Constants<Scalar, n>;
        using OfRows = typename DerivativeFreeReduced<dynamic, k>::template Constants<Scalar, n>;

        static AnyMap make(const OfStandard& own, Extent<n> joints, Extent<dynamic> lag_count,
                           Extent<k> /*rows*/) {
            return MapOf<Standard<dynamic>>(own, joints, lag_count, {});
        }
        static AnyMap make(const OfMeasured& own, Extent<n> joints, Extent<dynamic> /*lag_count*/,
                           Extent<k> /*rows*/) {
            return MapOf<StandardMeasured>(own, joints, {}, {});
        }
        static AnyMap make(const OfWindow& own, Extent<n> joints, Extent<dynamic> lag_count, Extent<k> rows) {
            return MapOf<DerivativeFree<dynamic>>(own, joints, lag_count, Extent<dynamic>{rows});
        }
        static AnyMap make(const OfRows& own, Extent<n> joints, Extent<dynamic> lag_count, Extent<k> rows) {
            return MapOf<DerivativeFreeReduced<dynamic, k>>(own, joints, lag_count, rows);
        }

        AnyMap map_;
    };
};

} // namespace dfdyn::tools
