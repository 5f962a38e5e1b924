// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"

#include <memory>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// A candidate with its columns as spectral rows.
struct CandidateEntry {
    Candidate candidate;
    std::vector<SpectralColumnPointer> columns;
    std::size_t own_columns, own_shapes; ///< before refinement

    CandidateEntry(const SpectralRows& rows, Candidate one)
        : candidate(std::move(one)), own_columns(candidate.columns.size()),
          own_shapes(candidate.shapes.size()) {
        complete(rows);
    }

    /// Replaces the shapes added by earlier refinements by shapes near the value of the shape `chosen`.
    /// Returns the new index of that shape.
    std::size_t refine(std::size_t chosen, const SpectralRows& rows) {
        const EffectShape shape = candidate.shapes[chosen];
        candidate.columns.resize(own_columns);
        candidate.shapes.resize(own_shapes);
        columns.resize(own_columns);
        for (const double factor : {1.0, 0.75, 0.87, 0.95, 1.05, 1.15, 1.33}) {
            EffectShape near = shape;
            near.value = factor * shape.value;
            near.columns.back() = candidate.columns.size();
            candidate.columns.push_back(candidate.at_value(shape, near.value));
            candidate.shapes.push_back(std::move(near));
        }
        // neighbouring shapes do not count as alternatives
        candidate.prior_trials =
            static_cast<double>(own_shapes) / static_cast<double>(candidate.shapes.size());
        complete(rows);
        return own_shapes;
    }

    /// Computes the rows of the columns that have none.
    void complete(const SpectralRows& rows) {
        for (std::size_t i = columns.size(); i < candidate.columns.size(); ++i) {
            columns.push_back(std::make_shared<const SpectralColumn>(rows, candidate.columns[i]));
        }
    }
};

} // namespace dfdyn::tools
