// SPDX-License-Identifier: Apache-2.0
#include "embedding.hpp"

#include <tools/build_flags.hpp>

int main() { return dfdyn::tools::build_flags().empty() ? 1 : run_example(); }
