// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/arm_unknowns.hpp"

#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <cmath>
#include <numeric>

namespace dfdyn::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd link_deviations(const DiagnosisSignals& signals) {
    const VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    constexpr double mass_share = 0.1, centre_m = 0.03, inertia_share = 0.3;
    constexpr double least = 1e-6; // of links without a mass
    VectorXd deviations(nominal.size());
    for (Index first = 0; first < nominal.size(); first += 10) {
        const double mass = nominal[first];
        const double inertia = (nominal[first + 4] + nominal[first + 7] + nominal[first + 9]) / 2;
        deviations[first] = mass_share * mass;
        deviations.segment<3>(first + 1).setConstant(centre_m * mass);
        deviations.segment<6>(first + 4).setConstant(inertia_share * std::abs(inertia));
    }
    return deviations.cwiseMax(least);
}

std::vector<Index> unknowns_of(const DiagnosisSignals& signals, Index joint) {
    std::vector<Index> result(static_cast<std::size_t>(signals.regressor.cols() + terms_of_joint));
    std::iota(result.begin(), result.end() - terms_of_joint, 0);
    std::iota(result.end() - terms_of_joint, result.end(), first_term(signals, joint));
    return result;
}

MatrixXd arm_columns(const DiagnosisSignals& signals, Index joint, const MatrixXd& terms) {
    MatrixXd result(signals.rows(), signals.regressor.cols() + terms.cols());
    result << signals.regressor(Eigen::seqN(joint, signals.rows(), signals.outputs()), Eigen::all), terms;
    return result;
}

VectorXd moving_weight(const DiagnosisSignals& signals, Index joint) {
    return signals.hardly_moves(static_cast<std::size_t>(joint)) ? VectorXd(VectorXd::Zero(signals.rows()))
                                                                 : row_weight(signals, joint);
}

} // namespace dfdyn::tools
