// SPDX-License-Identifier: Apache-2.0
// What begins, or happens, at a time that nobody knows.
#include "tools/diagnosis/candidates.hpp"
#include "tools/diagnosis/event_windows.hpp"
#include "tools/diagnosis/scans.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <optional>

namespace dfdyn::tools {

namespace {

/// Per output, how much energy a series has when it is weighed by the noise, of that before.
Eigen::VectorXd weighed_share(const EffectRegression& regression, const Eigen::VectorXd& series) {
    const Eigen::MatrixXd rows = regression.rows().analyse(series);
    const Eigen::MatrixXd precision = regression.noise().cwiseInverse();
    return (precision.transpose() * rows.cwiseAbs2().rowwise().sum()) / series.squaredNorm();
}

/// A series per row: of the weighed residual's products with some columns (p), and of their own (p (p + 1) /
/// 2), summed over the outputs.
struct Products {
    Eigen::MatrixXd moment, square;
    Eigen::Index columns;

    Products(const std::vector<EffectColumn>& of, const Eigen::MatrixXd& weighed,
             const Eigen::VectorXd& share)
        : moment(Eigen::MatrixXd::Zero(weighed.rows(), std::ssize(of))),
          square(Eigen::MatrixXd::Zero(weighed.rows(), std::ssize(of) * (std::ssize(of) + 1) / 2)),
          columns(std::ssize(of)) {
        for (Eigen::Index output = 0; output < weighed.cols(); ++output) {
            Eigen::Index at = 0;
            for (Eigen::Index i = 0; i < columns; ++i) {
                const Eigen::VectorXd* const one = series(of, i, output);
                if (one != nullptr) {
                    moment.col(i) += weighed.col(output).cwiseProduct(*one);
                }
                for (Eigen::Index j = 0; j <= i; ++j, ++at) {
                    const Eigen::VectorXd* const other = series(of, j, output);
                    if (one != nullptr && other != nullptr) {
                        square.col(at) += share[output] * one->cwiseProduct(*other);
                    }
                }
            }
        }
    }

    static const Eigen::VectorXd* series(const std::vector<EffectColumn>& of, Eigen::Index column,
                                         Eigen::Index output) {
        const auto& parts = of[static_cast<std::size_t>(column)].parts;
        const auto found = std::ranges::find(parts, output, &EffectColumn::Part::output);
        return found == parts.end() ? nullptr : &found->series;
    }

    /// Sum of squares that the columns explain where these are the sums of their products.
    double gain(const Eigen::VectorXd& moments, const Eigen::VectorXd& squares) const {
        Eigen::MatrixXd gram(columns, columns);
        Eigen::Index at = 0;
        for (Eigen::Index i = 0; i < columns; ++i) {
            for (Eigen::Index j = 0; j <= i; ++j, ++at) {
                gram(i, j) = gram(j, i) = squares[at];
            }
        }
        gram.diagonal().array() *= 1 + 1e-6;
        const Eigen::LDLT<Eigen::MatrixXd> factor(gram);
        return factor.isPositive() && gram.trace() > 0 ? moments.dot(factor.solve(moments)) : 0;
    }
};

constexpr double apart_s = 2; ///< windows closer than this tell of the same event

/// What an event has to explain before it is one; none where there are too few to compare with.
std::optional<double> demanded_by(const std::vector<EventWindow>& events) {
    constexpr std::size_t usual = 3; // three times what this one of its kind does
    return events.size() > usual ? std::optional(1.5 * events[usual].score) : std::nullopt;
}

/// All windows of one length.
void scan_windows(const DiagnosisSignals& signals, const EffectRegression& regression,
                  const Eigen::MatrixXd& weighed, const ContactSite& site, double length_s,
                  std::vector<EventWindow>& found) {
    const Eigen::VectorXd& time = signals.measured.time_s;
    const auto length = static_cast<Eigen::Index>(length_s * signals.measured.rate_hz);
    const Eigen::Index middle = time.size() / 2;
    if (middle + length >= time.size()) {
        return;
    }
    const Eigen::VectorXd series =
        pulse_series(signals, {time[middle], time[middle + length], push_flanks * length_s});
    const Products products(site.components, weighed, weighed_share(regression, series));
    const Eigen::VectorXd shape = series.segment(middle, length);
    const Eigen::VectorXd shape_square = shape.cwiseAbs2();
    for (Eigen::Index first = 0; first + length < time.size();
         first += std::max<Eigen::Index>(1, length / 8)) {
        const double gain =
            products.gain(products.moment.middleRows(first, length).transpose() * shape,
                          products.square.middleRows(first, length).transpose() * shape_square);
        found.push_back({gain, time[first], time[first + length]});
    }
}

/// As a payload's columns are weighed while they are `there` (T, 0 or 1): where they begin and end matters.
Products products_of_payload(const EffectRegression& regression, const Eigen::MatrixXd& weighed,
                             const std::vector<EffectColumn>& payload, const Eigen::VectorXd& there) {
    Eigen::VectorXd share = Eigen::VectorXd::Zero(weighed.cols());
    for (const EffectColumn::Part& part : payload.front().parts) {
        const Eigen::VectorXd series = part.series.cwiseProduct(there);
        share[part.output] = series.isZero(0) ? 0 : weighed_share(regression, series)[part.output];
    }
    return {payload, weighed, share};
}

/// What comes behind the fitted time leaves no residual.
Eigen::Index fitted_rows(const Eigen::MatrixXd& weighed) {
    Eigen::Index rows = weighed.rows();
    while (rows > 0 && weighed.row(rows - 1).isZero(0)) {
        --rows;
    }
    return rows;
}

} // namespace

std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighed, const std::vector<ContactSite>& sites) {
    std::vector<Candidate> result;
    for (const ContactSite& site : sites) {
        std::vector<EventWindow> windows;
        for (const double length_s : push_lengths_s) {
            scan_windows(signals, regression, weighed, site, length_s, windows);
        }
        const std::vector<EventWindow> events = events_of(windows, apart_s);
        if (const std::optional<double> demanded = demanded_by(events)) {
            const EventWindow& best = events.front();
            const ContactPulse pulse{best.start_s, best.end_s, push_flanks * (best.end_s - best.start_s)};
            result.push_back(contact_candidate(signals, site, pulse, pulses_about(pulse, 0.15)));
            result.back().tried = static_cast<double>(windows.size());
            result.back().extra_price = *demanded;
        }
    }
    return result;
}

std::vector<Candidate> scan_taken_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                                          const Eigen::MatrixXd& weighed,
                                          const std::vector<EffectColumn>& payload) {
    constexpr double least_share = 0.05; // of the time, before and after
    const Products products =
        products_of_payload(regression, weighed, payload, Eigen::VectorXd::Ones(signals.rows()));
    const Eigen::Index rows = fitted_rows(weighed);
    const auto margin = static_cast<Eigen::Index>(least_share * static_cast<double>(rows));
    Eigen::VectorXd moments = Eigen::VectorXd::Zero(products.moment.cols());
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(products.square.cols());
    double best = 0;
    Eigen::Index taken = -1;
    for (Eigen::Index row = rows - 1; row >= margin; --row) {
        moments += products.moment.row(row).transpose();
        squares += products.square.row(row).transpose();
        const double gain = row + margin < rows ? products.gain(moments, squares) : 0;
        if (gain > best) {
            best = gain;
            taken = row;
        }
    }
    if (taken < 0) {
        return {};
    }
    const double time_s = signals.measured.time_s[taken];
    Candidate candidate =
        taken_payload(signals, payload, {time_s, time_s - 0.3, time_s - 0.1, time_s + 0.1, time_s + 0.3});
    candidate.tried = signals.measured.time_s[signals.rows() - 1] - signals.measured.time_s[0];
    return {std::move(candidate)};
}

double demanded_of_payload(const DiagnosisSignals& signals, const EffectRegression& regression,
                           const Eigen::MatrixXd& weighed, const std::vector<EffectColumn>& payload,
                           double taken_s) {
    const Eigen::VectorXd& time = signals.measured.time_s;
    const Eigen::Index rows = fitted_rows(weighed);
    const Eigen::Index length = (time.head(rows).array() >= taken_s).count();
    const auto every_other = Eigen::VectorXd::NullaryExpr(signals.rows(), [length](Eigen::Index row) {
        return row / std::max<Eigen::Index>(1, length) % 2 == 0 ? 1.0 : 0.0;
    });
    const Products products = products_of_payload(regression, weighed, payload, every_other);
    std::vector<EventWindow> windows;
    for (Eigen::Index first = 0; length > 0 && first + length <= rows;
         first += std::max<Eigen::Index>(1, length / 8)) {
        const double gain = products.gain(products.moment.middleRows(first, length).colwise().sum(),
                                          products.square.middleRows(first, length).colwise().sum());
        windows.push_back({gain, time[first], time[first + length - 1]});
    }
    return demanded_by(events_of(std::move(windows), apart_s)).value_or(0);
}

} // namespace dfdyn::tools
