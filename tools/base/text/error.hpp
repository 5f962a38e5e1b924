// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace dfdyn::tools {

/// What the user can mend: bad usage, a bad input file, a place that cannot be written. The message is one
/// line that says where (file, line, column), what was expected and what was found. `main` prints it on
/// stderr and exits with 2.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace dfdyn::tools
