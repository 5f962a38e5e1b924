// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn {

/// Returns the identity of an input, as contained in a snapshot's model identity: the type's, or the
/// constants' if a host program selects the input at run time (`Input::identity_of`).
template <class Input, class Constants>
constexpr int input_identity(const Constants& constants) noexcept {
    if constexpr (requires { Input::identity_of(constants); }) {
        return Input::identity_of(constants);
    } else {
        return Input::identity;
    }
}

} // namespace dfdyn
