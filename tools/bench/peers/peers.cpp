// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/bench_learner.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace dfdyn::tools {

namespace {

constexpr std::array<const Peer*, 4> all_peers{&eigen_peer, &gurls_peer, &qrupdate_peer, &dlib_peer};

} // namespace

BenchLearners peers(const RegressionTask& task) {
    keep_blas_on_one_core();
    BenchLearners all;
    for (const Peer* const peer : all_peers) {
        if (peer->make != nullptr) {
            std::ranges::move(peer->make(task), std::back_inserter(all));
        }
    }
    return all;
}

std::vector<std::string> missing_peers() {
    std::vector<std::string> missing;
    for (const Peer* const peer : all_peers) {
        if (peer->missing != nullptr) {
            missing.emplace_back(peer->missing);
        }
    }
    return missing;
}

} // namespace dfdyn::tools
