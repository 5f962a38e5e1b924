// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A candidate in the search: columns of the normal equations. The other members are those of `Candidate`.
struct SearchCandidate {
    /// As `EffectShape`; each coefficient that another one bounds counts half.
    struct Shape {
        std::vector<Eigen::Index> columns; ///< of the normal equations
        CoefficientRule allowed;
        double bounded_count = 0;
        NearestCoefficients nearest = {};
    };
    std::vector<Shape> shapes;
    std::size_t family = 0;         ///< number of its family; 0: no family
    double candidates_of_class = 1; ///< number of candidates of its class
    double prior_trials = 1;
    double evidence_offset = 0;
    bool may_be_half = false; ///< with a second effect it can resemble a third one
};

/// A candidate and one of its shapes.
struct ChosenShape {
    std::size_t candidate = 0, shape = 0;
    bool operator==(const ChosenShape&) const = default;
};

/// Columns that are part of every model, with the prior standard deviation of their coefficients.
struct NuisanceColumn {
    Eigen::Index column = 0;
    double deviation = 1;
};

struct SearchProblem {
    WeightedSums sums;
    std::vector<SearchCandidate> candidates;
    std::vector<NuisanceColumn> nuisance;
};

/// A fitted model: nuisance parameters and chosen shapes, with their coefficients.
struct EffectFit {
    std::vector<Eigen::Index> columns; ///< nuisance first, then those of the chosen shapes in order
    Eigen::VectorXd coefficients;      ///< of `columns`
    Eigen::MatrixXd covariance;        ///< of the coefficients, for noise with the assumed weights
    double explained = 0;              ///< weighted sum of squares that the model explains
    double score = 0;                  ///< log-evidence, up to a constant
    bool allowed = true;               ///< every coefficient is admissible

    /// Returns the coefficients of `all` columns of the normal equations, with zeros for columns outside the
    /// model.
    Eigen::VectorXd of_all(Eigen::Index all) const;
};

/// Fits a model and computes its evidence. Priors: uniform in the logarithm of an effect's size; normal with
/// the given standard deviation for the nuisance parameters; one candidate of each class is present; all
/// shapes of a candidate have the same probability.
EffectFit fit_effects(const SearchProblem& problem, const std::vector<ChosenShape>& chosen);

/// Returns the log-evidence of a chosen effect that explains a sum of squares `explained`, in units of the
/// noise.
double evidence_of(const SearchProblem& problem, const ChosenShape& chosen, double explained);

/// Leave-one-block-out cross-validation score: the reduction of half the sum of squares in each block by the
/// fit to all other blocks, summed over the blocks. The prior penalty of the nuisance coefficients is
/// subtracted, because they could replace a removed effect. `blocks`: their sum is the problem's sums.
double held_out_score(const SearchProblem& problem, const std::vector<WeightedSums>& blocks,
                      const std::vector<ChosenShape>& chosen);

/// Returns `chosen` without the entry at `index`.
std::vector<ChosenShape> without(std::vector<ChosenShape> chosen, std::size_t index);

/// An addition of a candidate, or an exchange of a chosen one for it, and its score.
struct Replacement {
    ChosenShape with;
    double score = 0; ///< of the whole model; inadmissible and almost dependent candidates are left out
};

/// A model and the projections of all other columns on its complement. It evaluates models with one effect
/// added, removed or exchanged without a new factorization. `problem` must outlive it. Cost: k² p for k
/// columns of the model and p of the problem; k p for each exchanged effect.
class Neighbours {
  public:
    Neighbours(const SearchProblem& problem, const std::vector<ChosenShape>& chosen);

    double score() const noexcept { return score_; }
    /// Score of the model without the chosen effect at `index`.
    double score_without(std::size_t index) const;
    /// Returns every candidate outside the model, in its best shape, added to the model; best first.
    std::vector<Replacement> additions() const;
    /// Returns every candidate in place of the chosen one at `index`, including that one in its other shapes.
    std::vector<Replacement> exchanges(std::size_t index) const;

  private:
    /// Products of a shape's columns with each other and with the target, after projection on the complement
    /// of the model.
    struct Beyond {
        /// squares of the columns after projection on the complement of the nuisance columns
        Eigen::VectorXd own;
        Eigen::MatrixXd left;
        Eigen::VectorXd moment;
    };
    /// Additional residuals of all columns if an effect is removed: their squares are to be added.
    struct Returned {
        Eigen::MatrixXd columns; ///< columns of the effect x p
        Eigen::VectorXd moment;
    };
    Returned returned(std::size_t index) const;
    std::vector<Replacement> ranked(const std::vector<ChosenShape>& chosen, double base,
                                    const Returned& returned) const;

    const SearchProblem& problem_;
    std::vector<ChosenShape> chosen_;
    std::vector<Eigen::Index> columns_, first_; ///< of the model; the first column of each effect
    Eigen::VectorXd coefficients_;
    Eigen::MatrixXd covariance_, products_; ///< model x model, model x p
    std::vector<Beyond> beyond_;            ///< of all shapes of all candidates
    double score_ = 0;
};

/// Stepwise search: adds effects; where no addition helps, it removes or exchanges one; where that does not
/// help either, it removes one that may be half of another and exchanges a second one. It takes the best step
/// of its kind, until the evidence no longer increases.
std::vector<ChosenShape> search_effects(const SearchProblem& problem, std::vector<ChosenShape> start);

} // namespace dfdyn::tools
