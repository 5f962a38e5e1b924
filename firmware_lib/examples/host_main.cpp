// SPDX-License-Identifier: Apache-2.0
#include "embedding.hpp"

int main() { return run_example(); }
