// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace dfdyn::tools {

/// An error that the user can correct: wrong usage, a bad input file, a location that is not writable. The
/// message is one line with the place (file, line, column), what was expected and what was found. `main`
/// prints it on stderr and exits with 2.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A recording without the required columns.
class MissingColumns : public InputError {
  public:
    using InputError::InputError;
};

} // namespace dfdyn::tools
