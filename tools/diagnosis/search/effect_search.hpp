// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A candidate as the search sees it: columns of the regression.
struct SearchCandidate {
    struct Shape {
        std::vector<Eigen::Index> columns; ///< of the normal equations
        CoefficientRule allowed;
        double bounded = 0; ///< how many of the coefficients are bounded by another one: half of one each
        NearestCoefficients nearest = {};
    };
    std::vector<Shape> shapes;
    std::size_t family = 0; ///< of those with the same number, one at most; 0: of none
    double rivals = 1;      ///< how many candidates there are of its sort
    double tried = 1;       ///< how many alternatives it was picked from beforehand
    double extra_price = 0; ///< what it costs beside
};

/// A candidate in one of its shapes.
struct ChosenShape {
    std::size_t candidate = 0, shape = 0;
    bool operator==(const ChosenShape&) const = default;
};

/// Columns that are always there, with the standard deviation of their coefficients before anything was
/// measured.
struct NuisanceColumn {
    Eigen::Index column = 0;
    double deviation = 1;
};

struct SearchProblem {
    WeighedSums sums;
    std::vector<SearchCandidate> candidates;
    std::vector<NuisanceColumn> nuisance;
};

/// A model: nuisance and chosen shapes, with their coefficients.
struct EffectFit {
    std::vector<Eigen::Index> columns; ///< nuisance first, then the chosen shapes' in order
    Eigen::VectorXd coefficients;      ///< of `columns`
    Eigen::MatrixXd covariance;        ///< of them, were the noise just as weighed
    double explained = 0;              ///< sum of squares that it explains, weighed
    double score = 0;                  ///< logarithm of the evidence, up to a constant
    bool allowed = true;               ///< every coefficient has the sign it must have

    /// Of `all` columns of the normal equations, zero for those that are not in the model.
    Eigen::VectorXd of_all(Eigen::Index all) const;
};

/// Evidence of priors by which every order of magnitude of an effect is as likely, of the given deviations
/// for the nuisance; one in so many candidates of a sort is there, and any of its shapes is as likely.
EffectFit fit_effects(const SearchProblem& problem, const std::vector<ChosenShape>& chosen);

/// How well what fits all other blocks of rows predicts each, summed over the blocks: half the fall of the
/// sum of squares; less what the nuisance's coefficients cost, which could take a dropped effect's place.
/// `blocks`: those that the problem's sums are the sum of.
double held_out_score(const SearchProblem& problem, const std::vector<WeighedSums>& blocks,
                      const std::vector<ChosenShape>& chosen);

/// `chosen` less the one at `index`.
std::vector<ChosenShape> without(std::vector<ChosenShape> chosen, std::size_t index);

/// What replacing nothing, or one of the chosen, by each other candidate would give.
struct Replacement {
    ChosenShape with;
    double score = 0; ///< of the whole model; candidates that are not allowed or not excited are left out
};

/// A model, and what every other column of the problem is beyond it: the models with one effect more, less or
/// another one, without a new factor for each. `problem` must outlive it. Cost: k² p for k columns of the
/// model and p of the problem; k p for each effect that is exchanged.
class Neighbours {
  public:
    Neighbours(const SearchProblem& problem, const std::vector<ChosenShape>& chosen);

    double score() const noexcept { return score_; }
    /// Of the model without the chosen one at `index`.
    double score_without(std::size_t index) const;
    /// Every candidate that is not in the model, in its best shape, added to it; best first.
    std::vector<Replacement> additions() const;
    /// The same in the place of the chosen one at `index`, which may come back in any of its shapes.
    std::vector<Replacement> exchanges(std::size_t index) const;

  private:
    /// What the model leaves of a shape's columns, and of their products with what is to be explained.
    struct Beyond {
        Eigen::VectorXd own; ///< squares of what the nuisance leaves of the columns
        Eigen::MatrixXd left;
        Eigen::VectorXd moment;
    };
    /// What a smaller model leaves more, of all columns: squares of these are to be added.
    struct Returned {
        Eigen::MatrixXd columns; ///< effect's columns x p
        Eigen::VectorXd moment;
    };
    Returned returned(std::size_t index) const;
    std::vector<Replacement> ranked(const std::vector<ChosenShape>& chosen, double base,
                                    const Returned& returned) const;

    const SearchProblem& problem_;
    std::vector<ChosenShape> chosen_;
    std::vector<Eigen::Index> columns_, first_; ///< of the model; where each effect's begin among them
    Eigen::VectorXd coefficients_;
    Eigen::MatrixXd covariance_, products_; ///< model x model, model x p
    std::vector<Beyond> beyond_;            ///< of all shapes of all candidates
    double score_ = 0;
};

/// Adds, drops and exchanges, always the best step, until none raises the evidence.
std::vector<ChosenShape> search_effects(const SearchProblem& problem, std::vector<ChosenShape> start);

} // namespace dfdyn::tools
