// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/unexplained.hpp"

#include "tools/diagnosis/signals/smooth_functions.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr Eigen::Index blocks = 8;
constexpr std::size_t most_inputs = 6;

/// Smooth functions of one input: a matrix of spectral coefficients per function.
struct InputFunctions {
    std::vector<std::string> inputs;
    std::vector<Eigen::MatrixXd> rows; ///< bins x frames each
};

using Series = std::vector<Eigen::VectorXd>;

/// All smooth functions, with the weights and the bandwidth of `output`, as its residual.
std::vector<InputFunctions> all_functions(const DiagnosisSignals& signals, const SpectralRows& rows,
                                          Eigen::Index output) {
    const auto functions = [&](std::vector<std::string> names, const Series& series) {
        InputFunctions one{std::move(names), {}};
        for (const Eigen::VectorXd& function : series) {
            one.rows.push_back(rows.analyse(function, output));
        }
        return one;
    };
    std::vector<InputFunctions> result;
    const RobotMotion& motion = signals.measured.motion;
    for (Eigen::Index joint = 0; joint < motion.position.cols(); ++joint) {
        const std::string number = std::to_string(joint + 1);
        const std::string position = "q" + number;
        const std::string velocity = "qd" + number;
        const Series of_position = harmonics(motion.position.col(joint), 3);
        const Series of_velocity = harmonics(motion.velocity.col(joint), 3);
        result.push_back(functions({position}, of_position));
        result.push_back(functions({velocity}, of_velocity));
        result.push_back(functions({"qdd" + number}, harmonics(motion.acceleration.col(joint), 2)));
        Series products;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t k = 0; k < 4; ++k) {
                products.emplace_back(of_position[i].cwiseProduct(of_velocity[k]));
            }
        }
        result.push_back(functions({position, velocity}, products));
    }
    return result;
}

using BlockEdges = std::array<Eigen::Index, blocks + 1>;

/// Returns the first frame of each block, and the end. All blocks have about the same weight, so that each
/// shows a dependence also if the joint is stationary for long.
BlockEdges block_edges(const Eigen::RowVectorXd& filled) {
    BlockEdges edges{};
    double before = 0;
    Eigen::Index frame = 0;
    for (std::size_t block = 1; block < blocks; ++block) {
        const double wanted = filled.sum() * static_cast<double>(block) / blocks;
        while (frame < filled.size() && before + filled[frame] / 2 < wanted) {
            before += filled[frame++];
        }
        edges[block] = frame;
    }
    edges.back() = filled.size();
    return edges;
}

/// Returns the sums of each block of time.
std::vector<WeightedSums> block_sums(const std::vector<const Eigen::MatrixXd*>& columns,
                                     const Eigen::MatrixXd& target, const Eigen::VectorXd& noise,
                                     const BlockEdges& edges) {
    std::vector<WeightedSums> sums;
    const Eigen::VectorXd weight = noise.cwiseSqrt().cwiseInverse();
    for (std::size_t block = 0; block < blocks; ++block) {
        const Eigen::Index first = edges[block];
        const Eigen::Index count = edges[block + 1] - first;
        Eigen::MatrixXd matrix(target.rows() * count, static_cast<Eigen::Index>(columns.size()));
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const Eigen::MatrixXd part = weight.asDiagonal() * columns[i]->middleCols(first, count);
            matrix.col(static_cast<Eigen::Index>(i)) = part.reshaped();
        }
        const Eigen::MatrixXd wanted = weight.asDiagonal() * target.middleCols(first, count);
        sums.push_back({matrix.transpose() * matrix, matrix.transpose() * wanted.reshaped()});
    }
    return sums;
}

/// Returns, per block, the reduction of its sum of squares by the fit to all other blocks.
Eigen::VectorXd held_out_reductions(const std::vector<WeightedSums>& sums) {
    Eigen::MatrixXd gram = sums.front().gram;
    Eigen::VectorXd moment = sums.front().moment;
    for (std::size_t block = 1; block < sums.size(); ++block) {
        gram += sums[block].gram;
        moment += sums[block].moment;
    }
    Eigen::VectorXd reductions(blocks);
    for (std::size_t block = 0; block < sums.size(); ++block) {
        Eigen::MatrixXd others = gram - sums[block].gram;
        others.diagonal().array() *= 1.001; // functions over a narrow range are almost dependent
        others.diagonal().array() += 1;
        reductions[static_cast<Eigen::Index>(block)] =
            2 * held_out_reduction(others, moment - sums[block].moment, sums[block]);
    }
    return reductions;
}

/// Returns whether the mean reduction is significantly above zero.
bool certain(const Eigen::VectorXd& reductions) {
    constexpr double quantile = 4; // of Student's t-distribution with 7 degrees of freedom: 0.3 % one-sided
    const double mean = reductions.mean();
    const double scatter =
        (reductions.array() - mean).matrix().norm() / std::sqrt(static_cast<double>(blocks - 1));
    return mean > quantile * scatter / std::sqrt(static_cast<double>(blocks));
}

void list_inputs(Unexplained& entry, const std::vector<std::string>& inputs) {
    for (const std::string& input : inputs) {
        if (std::ranges::find(entry.depends_on, input) == entry.depends_on.end()) {
            entry.depends_on.push_back(input);
        }
    }
}

constexpr const char* no_name = "predictable, but by no cause of the catalogue";

double share_of_deviation(const Eigen::VectorXd& series, const Eigen::VectorXd& measured) {
    const Eigen::ArrayXd centred = measured.array() - measured.mean();
    return series.norm() / centred.matrix().norm();
}

} // namespace

std::vector<Unexplained> unnamed_dependences(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                             const FittedEffects& fitted_effects) {
    std::vector<Unexplained> result;
    for (const ChosenShape& one : fitted_effects.chosen) {
        const Candidate& candidate = fitted_effects.candidates[one.candidate];
        if (candidate.named()) {
            continue;
        }
        const Eigen::Index output = candidate.columns.front().parts.front().output;
        const Eigen::MatrixXd contribution = fitted_effects.contribution_of(
            signals, [&](const Candidate& other) { return other.key() == candidate.key(); });
        add_rest(result, {{output, share_of_deviation(contribution.col(output), measured.col(output)),
                           candidate.inputs, no_name}});
    }
    return result;
}

void add_rest(std::vector<Unexplained>& unexplained, const std::vector<Unexplained>& rest) {
    for (const Unexplained& one : rest) {
        const auto same = std::ranges::find(unexplained, one.output, &Unexplained::output);
        if (same == unexplained.end()) {
            unexplained.push_back(one);
        } else {
            list_inputs(*same, one.depends_on);
            same->nrmse = std::hypot(same->nrmse, one.nrmse);
        }
    }
}

namespace {

/// Inputs on which an output's residual depends, and the error reduction by their model in each held-out
/// block.
struct FoundInputs {
    Unexplained entry;
    Eigen::VectorXd reductions = Eigen::VectorXd::Zero(blocks);
};

/// Forward selection of inputs, while their model improves the prediction of held-out blocks.
FoundInputs inputs_of_rest(const std::vector<InputFunctions>& candidates, const Eigen::MatrixXd& target,
                           const Eigen::VectorXd& noise, const BlockEdges& edges, Eigen::Index output) {
    FoundInputs found{.entry = {output, 0, {}, {}}};
    std::vector<const Eigen::MatrixXd*> chosen;
    for (std::size_t step = 0; step < most_inputs; ++step) {
        Eigen::VectorXd best = found.reductions;
        const InputFunctions* added = nullptr;
        for (const InputFunctions& candidate : candidates) {
            std::vector<const Eigen::MatrixXd*> columns = chosen;
            for (const Eigen::MatrixXd& column : candidate.rows) {
                columns.push_back(&column);
            }
            const Eigen::VectorXd with = held_out_reductions(block_sums(columns, target, noise, edges));
            if (with.sum() > best.sum() && certain(with - found.reductions)) {
                best = with;
                added = &candidate;
            }
        }
        if (added == nullptr) {
            break;
        }
        found.reductions = best;
        list_inputs(found.entry, added->inputs);
        for (const Eigen::MatrixXd& column : added->rows) {
            chosen.push_back(&column);
        }
    }
    return found;
}

} // namespace

std::vector<Unexplained> unexplained_rest(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                          const Eigen::MatrixXd& rest, const Eigen::MatrixXd& noise) {
    const SpectralRows rows(signals.measured);
    std::vector<Unexplained> result;
    if (rows.frames() < 2 * blocks) {
        return result;
    }
    for (Eigen::Index output = 0; output < rest.cols(); ++output) {
        const std::vector<InputFunctions> candidates = all_functions(signals, rows, output);
        const Eigen::MatrixXd target = rows.analyse(rest.col(output), output);
        auto [entry, reductions] =
            inputs_of_rest(candidates, target, noise.col(output), block_edges(rows.filled(output)), output);
        if (entry.depends_on.empty()) {
            continue;
        }
        const double share =
            reductions.sum() /
            (noise.col(output).cwiseSqrt().cwiseInverse().asDiagonal() * target).squaredNorm();
        entry.nrmse =
            std::sqrt(std::max(0.0, share)) * share_of_deviation(rest.col(output), measured.col(output));
        entry.note = no_name;
        result.push_back(std::move(entry));
    }
    return result;
}

void set_unexplained(DiagnosisWork& work) {
    std::vector<Unexplained>& unexplained = work.diagnosis.unexplained;
    const std::vector<bool>& by_least_squares = work.diagnosis.by_least_squares;
    unexplained = unnamed_dependences(*work.signals, work.measured, work.fitted_effects);
    std::erase_if(unexplained, [&](const Unexplained& one) {
        return by_least_squares[static_cast<std::size_t>(one.output)];
    });
    Eigen::MatrixXd rest = work.rest;
    for (Eigen::Index output = 0; output < rest.cols(); ++output) {
        if (by_least_squares[static_cast<std::size_t>(output)]) {
            rest.col(output) = work.measured.col(output) - work.extended.col(output);
        }
    }
    for (const StationaryContact& push : work.pushes) { // a named cause
        if (by_least_squares[push.joint]) {
            rest.col(static_cast<Eigen::Index>(push.joint)) -= push.share;
        }
    }
    add_rest(unexplained, unexplained_rest(*work.signals, work.measured, rest, work.fitted_effects.noise));
}

} // namespace dfdyn::tools
