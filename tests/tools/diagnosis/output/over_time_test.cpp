// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/over_time.hpp"

#include "tests/support/catch.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <cmath>

namespace over_time_test {

using namespace dfdyn::tools;

/// Ten rows at 10 Hz from `first_s` on, with a gap of 5 s before row 4.
MeasuredMotion with_gap(double first_s) {
    MeasuredMotion measured;
    measured.rate_hz = 10;
    measured.time_s = Eigen::VectorXd::LinSpaced(10, first_s, first_s + 0.9);
    measured.time_s.tail(6).array() += 5;
    measured.stretches = {{0, 4}, {4, 6}};
    return measured;
}

TEST_CASE("a line over time is interrupted at the gap of the recording and nowhere else") {
    const Eigen::VectorXd series = Eigen::VectorXd::LinSpaced(10, 0, 9);
    const XyLine line = line_over_time(with_gap(0), "error", series, {0, 3, 5, 9}); // unequal steps
    REQUIRE(line.y.size() == 5);
    CHECK(line.y[1] == 3);
    CHECK(std::isnan(line.y[2]));
    CHECK(line.y[3] == 5);
    CHECK(line.x[3] == Approx(5.5));
}

TEST_CASE("a time axis counts times since 1970 from the first second of the recording and has its date") {
    CHECK(time_axis(with_gap(3)).label == "time (s)");
    CHECK(time_axis(with_gap(3)).origin_s == 0);
    const MeasuredMotion measured = with_gap(1'700'000'000.25);
    CHECK(time_axis(measured).label == "time after 2023-11-14 22:13:20.00 UTC (s)");
    const XyLine line = line_over_time(measured, "error", Eigen::VectorXd::Zero(10), {0, 1});
    CHECK(line.x[0] == Approx(0.25));
}

TEST_CASE("a contact in a recording since 1970 is drawn with the time around it") {
    DiagnosisSignals signals;
    signals.measured = with_gap(1'700'000'000.25);
    signals.nominal = Eigen::MatrixXd::Zero(10, 1);
    Finding contact;
    contact.effect = effects::external_contact().name;
    contact.where = "joint1";
    const double start_s = signals.measured.time_s[4];
    contact.parameters = {{"start", "s", start_s, 0, 0}, {"end", "s", start_s + 0.2, 0, 0}};
    const PlotAbscissa over = plot_abscissa(signals, contact, Eigen::VectorXd::Zero(10));
    CHECK(over.first == 4); // the rows before the gap are 5 s earlier
    CHECK(over.count == 6);
    CHECK(over.value[4] == Approx(5.65));
}

} // namespace over_time_test
