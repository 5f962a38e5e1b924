// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/contender.hpp"

#include <algorithm>
#include <iterator>

namespace dfdyn::tools {

Contenders peers(const RegressionTask& task) {
    keep_blas_on_one_core();
    Contenders all = eigen_peers(task);
    for (const auto make : {gurls_peers, qrupdate_peers, dlib_peers}) {
        std::ranges::move(make(task), std::back_inserter(all));
    }
    return all;
}

std::vector<std::string> missing_peers() {
    std::vector<std::string> missing{
        "GURLS (the paper's tool) is not in Debian, and does not build against today's Boost. Its stand-in "
        "makes the same calls of BLAS for a sample, in the same order in memory, and the same copies of the "
        "factor; nothing else, so that GURLS cannot be faster. iCub's learningMachine is not measured here."};
    if (!has_blas()) {
        missing.emplace_back("BLAS: not installed when this program was built (libopenblas-serial-dev).");
    }
    if (!has_qrupdate()) {
        missing.emplace_back("qrupdate: not installed when this program was built (libqrupdate-dev).");
    }
    if (!has_dlib()) {
        missing.emplace_back("dlib: not installed when this program was built (libdlib-dev).");
    }
    return missing;
}

} // namespace dfdyn::tools
