// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/contender.hpp"

#include <algorithm>
#include <iterator>

namespace dfdyn::tools {

Contenders peers(const RegressionTask& task) {
    Contenders all = eigen_peers(task);
    for (const auto make : {qrupdate_peers, dlib_peers}) {
        std::ranges::move(make(task), std::back_inserter(all));
    }
    return all;
}

std::vector<std::string> missing_peers() {
    std::vector<std::string> missing{"GURLS (recursive Cholesky, double, the paper's tool): not run here. "
                                     "Debian does not have it, and it does "
                                     "not build against today's Boost."};
    if (!has_qrupdate()) {
        missing.emplace_back("qrupdate: not installed when this program was built (libqrupdate-dev).");
    }
    if (!has_dlib()) {
        missing.emplace_back("dlib: not installed when this program was built (libdlib-dev).");
    }
    return missing;
}

} // namespace dfdyn::tools
