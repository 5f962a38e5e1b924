// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn {

/// Returns the number of an input's kind, as a snapshot's model identity contains it: that of the type, or of
/// the constants where a host program chooses the kind at run time (`Input::identity_of`).
template <class Input, class Constants>
constexpr int input_identity(const Constants& constants) noexcept {
    if constexpr (requires { Input::identity_of(constants); }) {
        return Input::identity_of(constants);
    } else {
        return Input::identity;
    }
}

} // namespace dfdyn
