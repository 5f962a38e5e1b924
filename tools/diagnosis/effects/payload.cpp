// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/event_products.hpp"
#include "tools/diagnosis/candidates/point_mass.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind payload_mass{"mass", "kg"};
constexpr std::array payload_centre{ParameterKind{"com_x", "m"}, ParameterKind{"com_y", "m"},
                                    ParameterKind{"com_z", "m"}};
constexpr ParameterKind payload_attached{"attached", "s", std::nullopt};
constexpr const char* one_payload = "payload"; // family: at most one payload, either permanent or picked up

/// Best mass and first moments with the centre of mass at its farthest admissible distance, by the Lagrange
/// multiplier of this bound.
Eigen::VectorXd at_farthest(const Eigen::MatrixXd& squares, const Eigen::VectorXd& moments) {
    constexpr double margin = 0.999;
    const double bound = margin * farthest_payload;
    // the quadratic form of the coefficients that is 0 at the bound
    Eigen::VectorXd cone = Eigen::VectorXd::Ones(moments.size());
    cone[0] = -bound * bound;
    const auto at = [&](double multiplier) {
        Eigen::MatrixXd system = squares;
        system.diagonal() += multiplier * cone;
        const Eigen::LLT<Eigen::MatrixXd> factor(system);
        return factor.info() == Eigen::Success ? Eigen::VectorXd(factor.solve(moments))
                                               : Eigen::VectorXd::Zero(moments.size()).eval();
    };
    double low = 0;
    double high = 1e-9 * squares.trace();
    const auto outside = [&](const Eigen::VectorXd& c) { return c.cwiseAbs2().dot(cone) > 0; };
    for (int doubling = 0; doubling < 60 && outside(at(high)); ++doubling) {
        low = high;
        high *= 2;
    }
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = (low + high) / 2;
        (outside(at(middle)) ? low : high) = middle;
    }
    return at(high);
}

bool within_reach(const Eigen::VectorXd& coefficients) {
    return coefficients[0] > 0 &&
           coefficients.tail(coefficients.size() - 1).norm() <= farthest_payload * coefficients[0];
}

/// Returns the position of the centre of mass (m, in the tip's frame): the tip if it was not fitted.
Eigen::Vector3d centre_of(const Eigen::VectorXd& coefficients, const EffectShape& shape) {
    return coefficients.size() > 1
               ? Eigen::Vector3d(mass_change(coefficients, shape).moments / coefficients[0])
               : Eigen::Vector3d::Zero();
}

std::vector<EffectParameter> payload_parameters(const Eigen::VectorXd& coefficients,
                                                const EffectShape& shape) {
    std::vector values{payload_mass.at(coefficients[0])};
    const Eigen::Vector3d centre = centre_of(coefficients, shape);
    for (std::size_t axis = 0; axis < payload_centre.size(); ++axis) {
        if (shape.columns.size() == 1 || has_moment(shape, axis)) {
            values.push_back(payload_centre[axis].at(centre[static_cast<Eigen::Index>(axis)]));
        }
    }
    return values;
}

/// Returns the shapes of a payload that the motion determines, first the one at the tip. `permanent`: columns
/// of a payload in the whole recording.
std::vector<EffectShape> payload_shapes(const std::vector<EffectColumn>& permanent) {
    std::vector<EffectShape> shapes = determined_shapes(permanent, {{0}, {0, 1, 2, 3}});
    std::erase_if(shapes, [](const EffectShape& shape) { return shape.columns.front() != 0; });
    for (EffectShape& shape : shapes) {
        shape.allowed = within_reach;
        shape.bounded_count = static_cast<double>(shape.columns.size() - 1);
        if (shape.columns.size() > 1) {
            shape.nearest = at_farthest;
        }
    }
    return shapes;
}

/// Returns the factor of the prior that keeps the one of payloads whose centre the motion determines.
double trials_of(const std::vector<EffectShape>& shapes) { return 2.0 / static_cast<double>(shapes.size()); }

/// A payload for the whole recording: at the tip, or with its centre of mass anywhere. Its moment of inertia
/// is exact at the tip and at `centre`.
Candidate payload_about(const DiagnosisSignals& signals, const Eigen::Vector3d& centre) {
    Candidate result;
    result.where = "tool";
    result.span = last_body;
    result.family = one_payload;
    result.columns = payload_columns(signals, centre);
    result.shapes = payload_shapes(result.columns);
    result.prior_trials = trials_of(result.shapes);
    result.relinearized_at = [&signals](const EffectShape& shape, const Eigen::VectorXd& coefficients) {
        return payload_about(signals, centre_of(coefficients, shape));
    };
    result.always_relinearized = true;
    result.parameters = payload_parameters;
    return result;
}

std::vector<Candidate> payload_candidates(const DiagnosisSignals& signals, std::size_t /*number*/) {
    return {payload_about(signals, Eigen::Vector3d::Zero())};
}

/// Products of the payload's columns, with the weight of the columns while `there` (T, 0 or 1) is 1: their
/// beginnings and ends influence the spectrum.
EventProducts products_of_payload(const EffectRegression& regression, const Eigen::MatrixXd& weighted,
                                  const std::vector<EffectColumn>& payload, const Eigen::VectorXd& there) {
    Eigen::VectorXd share = Eigen::VectorXd::Zero(weighted.cols());
    for (const EffectColumn::Part& part : payload.front().parts) {
        const Eigen::VectorXd series = part.series.cwiseProduct(there);
        share[part.output] = series.isZero(0) ? 0 : weighted_share(regression, series)[part.output];
    }
    return {payload, weighted, share};
}

/// Number of rows up to the last one with a residual. Rows after the fitted time have none.
Eigen::Index fitted_rows(const Eigen::MatrixXd& weighted) {
    Eigen::Index rows = weighted.rows();
    while (rows > 0 && weighted.row(rows - 1).isZero(0)) {
        --rows;
    }
    return rows;
}

/// Returns a payload (`payload`: its columns) that is picked up at the time that explains most.
std::vector<Candidate> scan_taken_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                                          const Eigen::MatrixXd& weighted,
                                          const std::vector<EffectColumn>& payload) {
    constexpr double least_share = 0.05; // of the time, before and after the payload is picked up
    const EventProducts products =
        products_of_payload(regression, weighted, payload, Eigen::VectorXd::Ones(signals.rows()));
    const Eigen::Index rows = fitted_rows(weighted);
    const auto margin = static_cast<Eigen::Index>(least_share * static_cast<double>(rows));
    Eigen::VectorXd moments = Eigen::VectorXd::Zero(products.moment.cols());
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(products.square.cols());
    double best = 0;
    Eigen::Index taken = -1;
    for (Eigen::Index row = rows - 1; row >= margin; --row) {
        moments += products.moment.row(row).transpose();
        squares += products.square.row(row).transpose();
        const double explained = row + margin < rows ? products.explained(moments, squares) : 0;
        if (explained > best) {
            best = explained;
            taken = row;
        }
    }
    if (taken < 0) {
        return {};
    }
    const double time_s = signals.measured.time_s[taken];
    Candidate candidate =
        taken_payload(signals, payload, {time_s, time_s - 0.3, time_s - 0.1, time_s + 0.1, time_s + 0.3});
    candidate.prior_trials *= signals.measured.time_s[signals.rows() - 1] - signals.measured.time_s[0];
    return {std::move(candidate)};
}

/// Searches for a payload that is picked up during the recording.
class PayloadScan : public EffectScan {
  public:
    explicit PayloadScan(const DiagnosisSignals& signals) : payload_(payload_columns(signals)) {}

    std::vector<Candidate> candidates(const FittedResidual& residual) const override {
        return scan_taken_payload(residual.signals, residual.regression, residual.weighted, payload_);
    }
    /// Every payload that is picked up, chosen or not, must exceed the other windows in the current residual.
    void set_evidence_offsets(const std::vector<Candidate*>& own,
                              const FittedResidual& residual) const override {
        for (Candidate* const candidate : own) {
            if (candidate->event) {
                candidate->evidence_offset =
                    payload_evidence_threshold(residual.signals, residual.regression, residual.weighted,
                                               payload_, candidate->shapes.front().value);
            }
        }
    }

  private:
    std::vector<EffectColumn> payload_;
};

EffectDisposition extend_by_payload(ModelExtension& extension, const ChosenEffect& chosen) {
    const InertialParameters payload =
        point_mass(chosen.coefficients[0], centre_of(chosen.coefficients, chosen.shape));
    extension.bodies.tail<10>() += moved(payload, extension.robot.tip_placement);
    return EffectDisposition::adapting;
}

} // namespace

std::vector<EffectColumn> payload_columns(const DiagnosisSignals& signals, const Eigen::Vector3d& centre) {
    const Eigen::Index last = signals.regressor.cols() / 10 - 1;
    return mass_columns(signals, last, Eigen::Vector3d::Zero(), signals.robot.tip_placement, centre);
}

Candidate taken_payload(const DiagnosisSignals& signals, const std::vector<EffectColumn>& permanent,
                        const std::vector<double>& times_s) {
    Candidate result;
    result.where = "tool";
    result.detail = "taken";
    result.family = one_payload;
    result.event = true;
    std::vector<EffectShape> shapes = payload_shapes(permanent);
    result.prior_trials = trials_of(shapes);
    for (EffectShape& shape : shapes) {
        shape.nearest = {}; // the time that explains most must have an admissible centre
    }
    for (const double time_s : times_s) {
        const std::size_t first = result.columns.size();
        const Eigen::VectorXd there = (signals.measured.time_s.array() >= time_s).cast<double>();
        for (EffectColumn column : permanent) {
            for (EffectColumn::Part& part : column.parts) {
                part.series = part.series.cwiseProduct(there);
            }
            result.columns.push_back(std::move(column));
        }
        for (EffectShape shape : shapes) {
            std::ranges::for_each(shape.columns, [first](std::size_t& column) { column += first; });
            shape.value = time_s;
            result.shapes.push_back(std::move(shape));
        }
    }
    result.relinearized_at = [&signals, &permanent](const EffectShape& shape, const Eigen::VectorXd&) {
        const double time_s = shape.value;
        return taken_payload(signals, permanent,
                             {time_s, time_s - 0.12, time_s - 0.04, time_s + 0.04, time_s + 0.12});
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        std::vector<EffectParameter> values = payload_parameters(coefficients, shape);
        values.push_back(payload_attached.at(shape.value));
        return values;
    };
    return result;
}

double payload_evidence_threshold(const DiagnosisSignals& signals, const EffectRegression& regression,
                                  const Eigen::MatrixXd& weighted, const std::vector<EffectColumn>& payload,
                                  double taken_s) {
    const Eigen::VectorXd& time = signals.measured.time_s;
    const Eigen::Index rows = fitted_rows(weighted);
    const Eigen::Index length = (time.head(rows).array() >= taken_s).count();
    const auto every_other = Eigen::VectorXd::NullaryExpr(signals.rows(), [length](Eigen::Index row) {
        return row / std::max<Eigen::Index>(1, length) % 2 == 0 ? 1.0 : 0.0;
    });
    const EventProducts products = products_of_payload(regression, weighted, payload, every_other);
    std::vector<EventWindow> windows;
    for (Eigen::Index first = 0; length > 0 && first + length <= rows;
         first += std::max<Eigen::Index>(1, length / 8)) {
        const double explained =
            products.explained(products.moment.middleRows(first, length).colwise().sum(),
                               products.square.middleRows(first, length).colwise().sum());
        windows.push_back({explained, time[first], time[first + length - 1]});
    }
    return noise_event_threshold(events_of(std::move(windows), events_apart_s)).value_or(0);
}

Effect effects::payload() {
    return {.name = "payload",
            .where = "tool",
            .parameters = {payload_mass, payload_centre[0], payload_centre[1], payload_centre[2],
                           payload_attached},
            .remark = " if it was picked up during the recording",
            .evidence = "is that of a mass fixed to the tool",
            .experiment = "take everything off the tool and record the same motion again",
            .in_extended_model = "adapting: the rigid body's parameters start there",
            .each = Each::arm,
            .candidates = payload_candidates,
            .scan = [](const DiagnosisSignals& signals, const SpectralRows&) -> std::unique_ptr<EffectScan> {
                return std::make_unique<PayloadScan>(signals);
            },
            .extend = extend_by_payload};
}

} // namespace dfdyn::tools
