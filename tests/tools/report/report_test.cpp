// SPDX-License-Identifier: Apache-2.0
#include "tools/report/report.hpp"

#include "tests/support/catch.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace report_test {

namespace tools = dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using nlohmann::json;
using tools::Report;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

Report small_report() {
    Report report;
    report.title = "A replay";
    report.summary = "It went well.";
    report.tables = {{"Errors", {"Output", "nRMSE"}, {{"tau1", 0.125}, {"tau2", 0.25}}, "a note"}};
    report.facts = {{"Model", "SP"}};
    report.time_s = {0.0, 0.1, 0.2, 1e9 + 0.123456789};
    report.series = {
        {"tau1",
         "N·m",
         {1.5F, -2.25F, 3e-30F, 4.0F},
         {not_a_number, 0.1F, 0.2F, 0.3F},
         {not_a_number, 1.0F, 2.0F, 3.0F}},
        {"tau2", "N·m", {5.0F, 6.0F, 7.0F, 8.0F}, {9.0F, 10.0F, 11.0F, 12.0F}, {0.0F, 0.0F, 0.0F, 0.0F}}};
    report.innovation = {{not_a_number, 1.0F, 2.0F, 400.0F}, 9.21, "99 %"};
    report.intervals = {{0.1, 0.2, "push"}};
    report.recordings = {{0.0, 0.0, "a.csv"}, {0.2, 7.0, "b.csv"}};
    return report;
}

json data_of(const std::string& page) {
    const std::string_view opening = R"(<script type="application/json" id="report-data">)";
    const std::size_t start = page.find(opening);
    REQUIRE(start != std::string::npos);
    const std::size_t first = start + opening.size();
    return json::parse(page.substr(first, page.find("</script>", first) - first));
}

std::string decode_base64(const std::string& text) {
    const std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char character : text.substr(0, text.find('='))) {
        bits = (bits << 6U) | static_cast<std::uint32_t>(alphabet.find(character));
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> static_cast<unsigned>(count));
        }
    }
    return bytes;
}

/// The numbers in `packed`, on a little-endian host like those that run the tests.
template <typename Number>
std::vector<Number> numbers_in(const json& packed) {
    const std::string bytes = decode_base64(packed.get<std::string>());
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
    return numbers;
}

void check_same_numbers(const json& packed, const std::vector<float>& expected) {
    const auto numbers = numbers_in<float>(packed);
    REQUIRE(numbers.size() == expected.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        CAPTURE(i);
        CHECK((numbers[i] == expected[i] || (std::isnan(numbers[i]) && std::isnan(expected[i]))));
    }
}

std::size_t occurrences(std::string_view text, std::string_view wanted) {
    std::size_t count = 0;
    for (std::size_t at = text.find(wanted); at != std::string_view::npos; at = text.find(wanted, at + 1)) {
        ++count;
    }
    return count;
}

TEST_CASE("the page contains the exact numbers of series and time and innovation") {
    const Report report = small_report();
    const json data = data_of(tools::render_report(report));
    CHECK(numbers_in<double>(data["time_s"]) == report.time_s);
    REQUIRE(data["series"].size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(data["series"][i]["name"] == report.series[i].name);
        CHECK(data["series"][i]["unit"] == report.series[i].unit);
        check_same_numbers(data["series"][i]["measured"], report.series[i].measured);
        check_same_numbers(data["series"][i]["predicted"], report.series[i].predicted);
        check_same_numbers(data["series"][i]["standard_deviation"], report.series[i].standard_deviation);
    }
    check_same_numbers(data["innovation"]["normalised_squared"], report.innovation->normalised_squared);
    CHECK(data["innovation"]["threshold"] == 9.21);
    CHECK(data["innovation"]["threshold_label"] == "99 %");
}

TEST_CASE("the page contains intervals and recordings") {
    const json data = data_of(tools::render_report(small_report()));
    CHECK(data["intervals"] == json::parse(R"([{"start_s": 0.1, "end_s": 0.2, "label": "push"}])"));
    CHECK(data["recordings"] == json::parse(R"([{"start_s": 0.0, "first_t_s": 0.0, "name": "a.csv"},
                                                {"start_s": 0.2, "first_t_s": 7.0, "name": "b.csv"}])"));
}

TEST_CASE("title and summary and tables and facts are readable without the script") {
    const std::string page = tools::render_report(small_report());
    CHECK_THAT(page, ContainsSubstring("<title>A replay</title>"));
    CHECK_THAT(page, ContainsSubstring("<h1>A replay</h1>"));
    CHECK_THAT(page, ContainsSubstring("<p>It went well.</p>"));
    CHECK_THAT(page, ContainsSubstring("<td class=\"number\">0.125</td>"));
    CHECK_THAT(page, ContainsSubstring("<dt>Model</dt><dd><span>SP</span></dd>"));
}

TEST_CASE("the page needs no network") {
    const std::string page = tools::render_report(small_report());
    for (const std::string load : {"src=", "href=", "@import", "url(", "<link", "<img", "<iframe", "fetch(",
                                   "XMLHttpRequest", "import("}) {
        CAPTURE(load);
        CHECK(page.find(load) == std::string::npos);
    }
    const std::string comment = "/*! https://github.com/leeoniya/uPlot (v1.6.32) */";
    CHECK(occurrences(page, comment) == 1);
    CHECK(occurrences(page, "http://") + occurrences(page, "https://") == 1);
    CHECK_THAT(page, ContainsSubstring("content=\"default-src 'none'; style-src 'unsafe-inline'; "
                                       "script-src 'unsafe-inline'\""));
}

TEST_CASE("the page contains the licence of its library") {
    const std::string page = tools::render_report(small_report());
    CHECK_THAT(page, ContainsSubstring("The MIT License (MIT)"));
    CHECK_THAT(page, ContainsSubstring("Copyright (c) 2022 Leon Sorokin"));
}

TEST_CASE("texts of a report are escaped in the page") {
    const std::string hostile = "</script><script>alert(\"'&{{data}}\")</script><!--";
    const Report harmless = small_report();
    const auto place = GENERATE(
        as<std::function<std::string&(Report&)>>{}, [](Report & r) -> auto& { return r.title; },
        [](Report & r) -> auto& { return r.summary; },
        [](Report & r) -> auto& { return r.tables[0].caption; },
        [](Report & r) -> auto& { return r.tables[0].columns[1]; },
        [](Report & r) -> auto& { return std::get<std::string>(r.tables[0].rows[0][0]); },
        [](Report & r) -> auto& { return r.tables[0].note; },
        [](Report & r) -> auto& { return r.facts[0].name; },
        [](Report & r) -> auto& { return r.facts[0].value; },
        [](Report & r) -> auto& { return r.series[0].name; },
        [](Report & r) -> auto& { return r.series[0].unit; },
        [](Report & r) -> auto& { return r.innovation->threshold_label; },
        [](Report & r) -> auto& { return r.intervals[0].label; },
        [](Report & r) -> auto& { return r.recordings[0].name; });
    Report report = harmless;
    place(report) = hostile;
    const std::string page = tools::render_report(report);
    CHECK(page.find("alert(\"") == std::string::npos);
    const std::string before = tools::render_report(harmless);
    for (const std::string markup : {"<script", "</script", "<!--"}) {
        CAPTURE(markup);
        CHECK(occurrences(page, markup) == occurrences(before, markup));
    }
}

TEST_CASE("a name in the page's data equals the given name") {
    Report report = small_report();
    report.recordings[0].name = "</script>\"'&\\.csv";
    CHECK(data_of(tools::render_report(report))["recordings"][0]["name"] == "</script>\"'&\\.csv");
}

TEST_CASE("numbers that are not finite keep the page's data valid") {
    Report report = small_report();
    const float infinity = std::numeric_limits<float>::infinity();
    for (tools::ReportSeries& series : report.series) {
        series.measured = {not_a_number, infinity, -infinity, not_a_number};
        series.predicted =
            series.standard_deviation = {not_a_number, not_a_number, not_a_number, not_a_number};
    }
    report.innovation->normalised_squared = {not_a_number, infinity, not_a_number, not_a_number};
    const json data = data_of(tools::render_report(report));
    check_same_numbers(data["series"][0]["measured"], report.series[0].measured);
    check_same_numbers(data["series"][1]["predicted"], report.series[1].predicted);
    check_same_numbers(data["innovation"]["normalised_squared"], report.innovation->normalised_squared);
}

TEST_CASE("an empty report is a valid page") {
    const json data = data_of(tools::render_report({}));
    CHECK(data["time_s"].get<std::string>().empty());
    CHECK(data["series"] == json::array());
    CHECK(data["innovation"].is_null());
    CHECK(data["intervals"] == json::array());
}

TEST_CASE("an inconsistent report is rejected with the name of the field") {
    struct Mistake {
        std::function<void(Report&)> make;
        std::string message;
    };
    const double infinite = std::numeric_limits<double>::infinity();
    const auto mistake = GENERATE_REF(values<Mistake>({
        {[](Report& r) { r.series[1].measured.pop_back(); },
         "series[1] (tau2).measured: expected 4 values, found 3"},
        {[](Report& r) { r.series[0].predicted.push_back(0.0F); },
         "series[0] (tau1).predicted: expected 4 values, found 5"},
        {[](Report& r) { r.series[0].standard_deviation.clear(); },
         "series[0] (tau1).standard_deviation: expected 4"},
        {[](Report& r) { r.innovation->normalised_squared.pop_back(); },
         "innovation.normalised_squared: expected 4"},
        {[](Report& r) { r.innovation->threshold = 0.0; }, "innovation.threshold"},
        {[=](Report& r) { r.innovation->threshold = infinite; }, "innovation.threshold"},
        {[](Report& r) { r.time_s[2] = r.time_s[1]; }, "time_s[2]: expected a time after"},
        {[=](Report& r) { r.time_s[3] = infinite; }, "time_s[3]: expected a finite time"},
        {[](Report& r) { r.intervals[0].end_s = 0.05; }, "intervals[0]"},
        {[=](Report& r) { r.intervals[0].end_s = infinite; }, "intervals[0]"},
        {[=](Report& r) { r.intervals[0].start_s = -infinite; }, "intervals[0]"},
        {[](Report& r) { r.recordings[1].start_s = 0.0; }, "recordings[1]: expected a start after"},
        {[=](Report& r) { r.recordings[1].start_s = infinite; }, "recordings[1]: expected finite"},
        {[=](Report& r) { r.recordings[1].first_t_s = infinite; }, "recordings[1]: expected finite"},
        {[](Report& r) { r.tables[0].rows[1].pop_back(); }, "tables[0].rows[1]: expected 2 values, found 1"},
    }));
    CAPTURE(mistake.message);
    Report report = small_report();
    mistake.make(report);
    CHECK_THROWS_AS(tools::render_report(report), std::invalid_argument);
    CHECK_THROWS_WITH(tools::render_report(report), ContainsSubstring(mistake.message));
}

TEST_CASE("a report of 15 000 ticks and 6 outputs stays below 3 MB") {
    Report report;
    for (int tick = 0; tick < 15000; ++tick) {
        report.time_s.push_back(0.008 * tick);
    }
    const std::vector<float> values(report.time_s.size(), 1.2345678F);
    report.series.assign(6, {"i", "A", values, values, values});
    report.innovation = {values, 16.8, "99 %"};
    CHECK(tools::render_report(report).size() < 3'000'000);
}

Report report_of(int ticks) {
    Report report;
    for (int tick = 0; tick < ticks; ++tick) {
        report.time_s.push_back(0.001 * tick);
    }
    return report;
}

TEST_CASE(
    "a report of a million ticks is thinned and keeps the extremes of outputs, errors and innovations") {
    Report report = report_of(1'000'000);
    const std::vector<float> values(report.time_s.size(), 1.0F);
    report.series.assign(2, {"i", "A", values, values, values});
    report.series[1].measured[345'678] = 7.0F;
    report.series[0].predicted[765'432] = -9.0F; // an extreme of the error alone
    report.innovation = {values, 16.8, "99 %"};
    report.innovation->normalised_squared[543'210] = 400.0F;
    report.innovation->normalised_squared[543'211] = std::numeric_limits<float>::infinity();
    const std::string page = tools::render_report(report);
    CHECK(page.size() < 4'000'000);
    CHECK_THAT(page, ContainsSubstring(
                         "of 1000000 ticks, among them the extremes of outputs, errors and innovations"));
    const json data = data_of(page);
    const auto time_s = numbers_in<double>(data["time_s"]);
    CHECK(time_s.size() <= tools::most_report_ticks);
    CHECK(time_s.size() > tools::most_report_ticks / 10);
    const auto time_of = [&](const json& packed, float value) {
        const auto numbers = numbers_in<float>(packed);
        return time_s.at(static_cast<std::size_t>(std::ranges::find(numbers, value) - numbers.begin()));
    };
    CHECK(time_of(data["series"][1]["measured"], 7.0F) == report.time_s[345'678]);
    CHECK(time_of(data["series"][0]["predicted"], -9.0F) == report.time_s[765'432]);
    CHECK(time_of(data["innovation"]["normalised_squared"], 400.0F) == report.time_s[543'210]);
    CHECK(time_s.back() == report.time_s.back());
}

TEST_CASE("a thinned page links the table with all ticks and a complete page does not") {
    Report report = report_of(70'000);
    report.full_data = "run 1 & 2.ticks.csv";
    CHECK_THAT(tools::render_report(report),
               ContainsSubstring("All ticks are in <a href=\"./run%201%20%26%202.ticks.csv\">run 1 &amp; "
                                 "2.ticks.csv</a>."));
    report.time_s.resize(60'000);
    CHECK(tools::render_report(report).find("ticks.csv") == std::string::npos);
}

TEST_CASE("a thinned page leaves out the figures of the part in view, because its ticks are extreme ones") {
    const std::string reason = "Figures of the part in view need all ticks and are left out.";
    const std::string thinned = tools::render_report(report_of(60'001));
    CHECK(data_of(thinned)["thinned"] == true);
    CHECK_THAT(thinned, ContainsSubstring(reason));
    const std::string complete = tools::render_report(report_of(60'000));
    CHECK(data_of(complete)["thinned"] == false);
    CHECK(complete.find(reason) == std::string::npos);
}

TEST_CASE("a thinned page interrupts its curves at gaps and nowhere else") {
    const bool long_recording = GENERATE(false, true);
    CAPTURE(long_recording);
    Report report;
    const int ticks = long_recording ? 300'000 : 3000;
    double t = 1e9;
    for (int tick = 0; tick < ticks; ++tick) {
        t +=
            tick == ticks / 2 ? 0.02 : 0.001; // a gap of 20 samples; a thinned page has every 30th tick or so
        report.time_s.push_back(t);
    }
    const auto first_of_second = static_cast<std::size_t>(ticks / 3);
    report.recordings = {{report.time_s.front(), 0, "a.csv"}, {report.time_s[first_of_second], 0, "b.csv"}};
    const std::vector<float> flat(report.time_s.size(), 1.0F); // its extremes are far apart
    report.series.assign(6, {"i", "A", flat, flat, flat});
    const json data = data_of(tools::render_report(report));
    const auto time_s = numbers_in<double>(data["time_s"]);
    const auto breaks = data["breaks"].get<std::vector<std::size_t>>();
    REQUIRE(breaks.size() == 2);
    const auto gap = static_cast<std::size_t>(ticks / 2);
    for (const auto& [found, expected] : {std::pair{breaks[0], first_of_second}, {breaks[1], gap}}) {
        CHECK(time_s.at(found) == report.time_s.at(expected));
        CHECK(time_s.at(found - 1) == report.time_s.at(expected - 1));
    }
    CHECK(data["sample_time_s"].get<double>() == Approx(0.001).epsilon(1e-3));
}

} // namespace report_test
