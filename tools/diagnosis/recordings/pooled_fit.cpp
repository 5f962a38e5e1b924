// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/pooled_fit.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Weight of the expected spread, in recordings: with two it dominates, with six it has little influence.
constexpr double prior_recordings = 3;

using Factor = Eigen::LLT<MatrixXd>;

double log_determinant(const Factor& factor) { return 2 * factor.matrixLLT().diagonal().array().log().sum(); }

/// Difference d of a recording from the common value c.
struct Difference {
    Factor given_common; ///< factor of the precision of d given c
    MatrixXd gain;       ///< p x p: minus the derivative of the mean of d with respect to c
};

class RandomEffects {
  public:
    RandomEffects(const std::vector<RecordingInformation>& recordings, const PooledPrior& prior,
                  const VectorXd& start)
        : recordings_(recordings), prior_(prior) {
        fit_.value = VectorXd::Zero(size());
        fit_.ratio =
            start.size() > 0 ? start : VectorXd(VectorXd::Ones(*std::ranges::max_element(prior.group) + 1));
    }

    PooledFit fit() {
        constexpr int most_iterations = 60;
        constexpr double convergence = 1e-3;
        update_common(); // a first value, on which the expected spread depends
        for (int iteration = 0; iteration < most_iterations; ++iteration) {
            update_common();
            const VectorXd before = fit_.ratio;
            update_spread();
            if (((fit_.ratio - before).array().abs() < convergence * before.array()).all()) {
                break;
            }
        }
        update_common();
        for (std::size_t r = 0; r < recordings_.size(); ++r) {
            add_difference(r);
        }
        return fit_;
    }

  private:
    Index size() const { return prior_.covariance.rows(); }

    VectorXd expected_spread() const {
        const VectorXd size_of = fit_.value.cwiseAbs()(prior_.spread_of);
        return prior_.relative_spread.cwiseProduct(size_of).cwiseMax(prior_.least_spread);
    }

    /// Solves for the common value with the current spread.
    void update_common() {
        const VectorXd expected = expected_spread();
        fit_.spread = expected.cwiseProduct(fit_.ratio(prior_.group));
        const Factor prior(prior_.covariance);
        MatrixXd system = prior.solve(MatrixXd::Identity(size(), size()));
        VectorXd moment = VectorXd::Zero(size());
        fit_.evidence = -0.5 * log_determinant(prior);
        differences_.clear();
        for (std::size_t r = 0; r < recordings_.size(); ++r) {
            MatrixXd covariance = fit_.spread.cwiseAbs2().asDiagonal();
            if (!prior_.changed.empty()) {
                covariance += prior_.changed[r];
            }
            const Factor own(covariance);
            const RecordingInformation& one = recordings_[r];
            Factor given(one.information + own.solve(MatrixXd::Identity(size(), size())));
            const VectorXd mean = given.solve(one.moment);
            MatrixXd gain = given.solve(one.information);
            system += one.information - one.information * gain;
            moment += one.moment - one.information * mean;
            fit_.evidence += 0.5 * (one.moment.dot(mean) - log_determinant(given) - log_determinant(own));
            differences_.push_back({std::move(given), std::move(gain)});
        }
        const Factor common(0.5 * (system + system.transpose()));
        fit_.value = common.solve(moment);
        fit_.covariance = common.solve(MatrixXd::Identity(size(), size()));
        const Eigen::ArrayXd ratio = fit_.ratio.array();
        fit_.evidence += 0.5 * (moment.dot(fit_.value) - log_determinant(common)) -
                         prior_recordings * (ratio.log() + 0.5 * ratio.square().inverse()).sum();
    }

    VectorXd mean_difference(std::size_t r) const {
        const RecordingInformation& one = recordings_[r];
        return differences_[r].given_common.solve(one.moment - one.information * fit_.value);
    }

    /// Sets the ratio of each group to the mode of its posterior, given the expected squares of deviations.
    void update_spread() {
        const VectorXd expected = expected_spread();
        VectorXd squares = VectorXd::Constant(fit_.ratio.size(), prior_recordings);
        VectorXd counts = squares;
        for (std::size_t r = 0; r < recordings_.size(); ++r) {
            const Difference& difference = differences_[r];
            const VectorXd mean = mean_difference(r);
            const MatrixXd inverse = difference.given_common.solve(MatrixXd::Identity(size(), size()));
            const MatrixXd by_common = difference.gain * fit_.covariance;
            for (Index k = 0; k < size(); ++k) {
                const double changed = prior_.changed.empty() ? 0 : prior_.changed[r](k, k);
                if (changed > 0) {
                    continue; // an allowed change, such as a load, is no spread
                }
                const double variance = inverse(k, k) + by_common.row(k).dot(difference.gain.row(k));
                const Index group = prior_.group[static_cast<std::size_t>(k)];
                squares[group] += (mean[k] * mean[k] + variance) / (expected[k] * expected[k]);
                counts[group] += 1;
            }
        }
        fit_.ratio = squares.cwiseQuotient(counts).cwiseSqrt();
    }

    void add_difference(std::size_t r) {
        const Difference& difference = differences_[r];
        const MatrixXd inverse = difference.given_common.solve(MatrixXd::Identity(size(), size()));
        const MatrixXd kept = MatrixXd::Identity(size(), size()) - difference.gain;
        fit_.difference.push_back(mean_difference(r));
        fit_.difference_covariance.push_back(inverse +
                                             difference.gain * fit_.covariance * difference.gain.transpose());
        fit_.own_deviation.push_back(
            (inverse + kept * fit_.covariance * kept.transpose()).diagonal().cwiseMax(0).cwiseSqrt());
    }

    const std::vector<RecordingInformation>& recordings_;
    const PooledPrior& prior_;
    std::vector<Difference> differences_;
    PooledFit fit_;
};

} // namespace

PooledFit pool(const std::vector<RecordingInformation>& recordings, const PooledPrior& prior,
               const VectorXd& start) {
    if (recordings.empty()) {
        throw std::logic_error("pool: no recordings");
    }
    return RandomEffects(recordings, prior, start).fit();
}

} // namespace dfdyn::tools
