// SPDX-License-Identifier: Apache-2.0
#include "tools/build_flags.hpp"

#include <iostream>

/// Linked with every object of dfdyn::tools, whether it is used or not.
int main() { std::cout << dfdyn::tools::build_flags() << '\n'; }
