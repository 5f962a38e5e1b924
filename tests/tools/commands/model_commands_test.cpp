// SPDX-License-Identifier: Apache-2.0
// Models with a robot from the command line with simulate, train and replay.
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tools/base/text/number.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace model_commands_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string urdf = DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf";
const std::string robot = " --robot " + urdf + " --tip tool ";
const std::string icub =
    " --robot " DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf --base chest --tip r_hand ";

/// The rows of a CSV file without the columns for whose names `dropped` returns true.
template <class Dropped>
std::string without_columns(const std::string& csv, const Dropped& dropped) {
    std::istringstream lines(csv);
    std::vector<bool> kept;
    std::string result;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::vector<std::string> values;
        for (std::string field; std::getline(fields, field, ',');) {
            values.push_back(field);
        }
        std::string row;
        for (std::size_t column = 0; column < values.size(); ++column) {
            if (kept.size() < values.size()) {
                kept.push_back(!dropped(values[column]));
            }
            if (kept[column]) {
                row.append(row.empty() ? "" : ",").append(values[column]);
            }
        }
        result.append(row).append("\n");
    }
    return result;
}

/// A recording of the small arm and a folder for models.
class Bench {
  public:
    Bench() {
        REQUIRE(call("simulate --robot " + urdf +
                     " --scenario " DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json -o " + path("run.csv"))
                    .status == 0);
        write("positions.csv", without_columns(file_content(path("run.csv")), [](const std::string& name) {
                  return name.starts_with("qd");
              }));
    }

    std::string path(const std::string& name) const { return directory_.path() / name; }

    void write(const std::string& name, const std::string& content) const { directory_.write(name, content); }

    Outcome call(const std::string& arguments) const { return run_program(directory_, arguments); }

    Outcome train(const std::string& arguments, const std::string& model = "model.json") const {
        return call("train --log " + path("run.csv") +
                    " --rows :300 --features 12 --starts 1 --likelihood-rows 60 --refinement 0 -o " +
                    path(model) + " " + arguments);
    }

    Outcome replay(const std::string& log, const std::string& arguments = "") const {
        return call("replay --model " + path("model.json") + " --log " + log + " " + arguments);
    }

    nlohmann::json model() const { return nlohmann::json::parse(file_content(path("model.json"))); }

  private:
    TemporaryDirectory directory_;
};

/// The largest number after `label` in a summary.
double largest_figure(const std::string& summary, const std::string& label) {
    std::istringstream line(summary.substr(summary.find(label) + label.size()));
    std::string rest;
    std::getline(line, rest);
    std::istringstream figures(rest);
    double largest = -1;
    for (std::string word; figures >> word;) {
        if (word == "-") { // an output without a figure
            return std::numeric_limits<double>::quiet_NaN();
        }
        if (std::isdigit(static_cast<unsigned char>(word.front())) == 0) {
            break;
        }
        largest = std::max(largest, std::stod(word));
    }
    return largest;
}

struct Call {
    std::string arguments;
    /// Limit of the nRMSE of each output over the second half: a third above the value of one run.
    double error_below;
};

void check_refused(const Outcome& outcome, const std::string& words) {
    CAPTURE(outcome.error);
    CHECK(outcome.status == 2);
    CHECK(outcome.out.empty());
    const std::size_t message = outcome.error.find("dfdyn: ");
    REQUIRE(message != std::string::npos);
    CHECK(std::ranges::count(outcome.error.substr(message), '\n') == 1);
    CHECK_THAT(outcome.error, ContainsSubstring(words));
}

TEST_CASE("models with a robot are trained and replayed with one command each") {
    const Bench bench;
    const Call calls[] = {
        {"--outputs tau --model P --input DFSR --effects viscous_friction,coulomb_friction,torque_offset",
         0.08},
        {"--outputs wrench --model P --effects ft_bias --forgetting 0.999", 0.15},
        {"--outputs tau --model P --input STD --derivatives measured --hyper CV", 0.40},
        {"--outputs tau --model SP --input STD --derivatives estimated --effects viscous_friction", 0.13},
        {"--outputs tau --model SP --input DFW", 0.13},
        {"--outputs tau --model SP2 --input DFSR --lags 10 --hyper CV", 0.09},
        {"--outputs i --model SP --torque-constants 5,3 --effects coulomb_friction,rotor_inertia", 0.07},
        {"--outputs i --model SPK --shared-motion --effects stribeck_friction,joint_spring", 0.10},
        {"--outputs tau --model SPK --prior unit --input DF", 0.12},
        {"--outputs tau --model SPK --prior diagonal --input STD --derivatives measured", 0.10},
        {"--outputs wrench --model SPK --effects ft_bias --ft-joint sensor", 0.12},
    };
    for (const Call& call : calls) {
        CAPTURE(call.arguments);
        const Outcome trained = bench.train(robot + call.arguments + " --header " + bench.path("model.hpp"));
        CAPTURE(trained.error);
        REQUIRE(trained.status == 0);
        CHECK_THAT(trained.out, ContainsSubstring("parameters that the recording determines separately"));
        CHECK_FALSE(file_content(bench.path("model.hpp")).empty());
        const Outcome replayed = bench.replay(bench.path("run.csv"), "--rows 300: -o " + bench.path("r.csv"));
        CAPTURE(replayed.error);
        REQUIRE(replayed.status == 0);
        CHECK(std::ranges::count(file_content(bench.path("r.csv")), '\n') == 1 + 150);
        CAPTURE(replayed.out);
        const double error = largest_figure(replayed.out, "nRMSE, second half");
        CHECK(error > 0);
        CHECK(error < call.error_below);
    }
}

TEST_CASE("a replay compares a model with its rigid body and mentions once if there is none") {
    const Bench bench;
    const std::string rows = "--rows 300: --frozen";
    REQUIRE(bench.train(robot + "--outputs tau --model P --effects viscous_friction").status == 0);
    const std::string with_robot = bench.replay(bench.path("run.csv"), rows).out;
    CAPTURE(with_robot);
    for (const std::string label : {"rigid body of the URDF", "identified rigid body"}) {
        const double error = largest_figure(with_robot, label);
        CHECK(error > 0);
        CHECK(error < 0.5);
    }
    CHECK_THAT(with_robot, !ContainsSubstring("rigid body: -"));
    CHECK_THAT(bench.replay(bench.path("positions.csv"), rows).out, !ContainsSubstring("rigid body: -"));
    REQUIRE(bench.train("--outputs tau").status == 0);
    const std::string logs = bench.path("run.csv") + "," + bench.path("positions.csv");
    const std::string without = bench.replay(logs, rows).out;
    CAPTURE(without);
    CHECK(std::isnan(largest_figure(without, "identified rigid body")));
    CHECK_THAT(without, ContainsSubstring("rigid body: -: no model has one"));
    CHECK(without.find("rigid body: -") == without.rfind("rigid body: -"));
}

TEST_CASE("training with a robot repeats byte for byte") {
    const Bench bench;
    const std::string arguments = robot + "--outputs tau --model SPK --effects viscous_friction";
    REQUIRE(bench.train(arguments).status == 0);
    REQUIRE(bench.train(arguments, "again.json").status == 0);
    CHECK(file_content(bench.path("model.json")) == file_content(bench.path("again.json")));
    CHECK(bench.model()["structure"] == "SPK");
}

TEST_CASE("unusable training options for a robot are rejected with one line") {
    const Bench bench;
    const std::string tau = "--outputs tau --model ";
    const struct {
        std::string arguments, words;
    } cases[] = {
        {tau + "SP", "--model SP: expected --robot and --tip, found none"},
        {robot + tau + "P --effects wind", "found \"wind\""},
        {robot + tau + "P --effects viscous_friction,viscous_friction", "expected once, found twice"},
        {robot + "--outputs wrench --model P --effects viscous_friction",
         "effect \"viscous_friction\": expected one that a wrench can show (ft_bias)"},
        {robot + tau + "P --effects ft_bias", "effect \"ft_bias\""},
        {" --robot " + urdf + " --tip hand " + tau + "P", "expected a link \"hand\", found base"},
        {" --robot none.urdf --tip hand " + tau + "P", "none.urdf"},
        {icub + tau + "SPK", "expected a chain of 2 joints as the recording has, found 4"},
        {robot + "--outputs wrench --ft-joint wrist_2 --model P", "wrist_2"},
        {robot + tau + "SPK --hyper CV", "expected model NP, P or SP2 for cross validation, found SPK"},
        {robot + tau + "NP --hyper CV --input DFR", "cross validation, found DFR"},
        {robot + tau + "SP --input DFR --lags 4 --features-per-joint 6", "expected 1 to lags + 1 rows"},
        {robot + tau + "SP --shared-motion --features-per-joint 2", "expected at least 3 rows per joint"},
        {robot + tau + "P --lags 1", "expected at least 2 lags, found 1"},
        {robot + "--outputs i --model P --torque-constants 5", "expected 2, one per joint, found 1"},
        {robot + "--outputs i --model P --torque-constants 5,-3",
         "expected a finite number above 0, found \"-3\""},
    };
    for (const auto& one : cases) {
        CAPTURE(one.arguments);
        check_refused(bench.train(one.arguments), one.words);
        CHECK_FALSE(std::filesystem::exists(bench.path("model.json")));
    }
    check_refused(bench.call("train --log " + bench.path("positions.csv") +
                             " --outputs tau --input STD --derivatives measured -o " +
                             bench.path("model.json")),
                  "expected columns qd1… and qdd1… for measured derivatives, found none");
    std::string velocities = "t,q1,q2,qd1,qd2,tau1,tau2\n";
    for (int row = 0; row < 100; ++row) {
        const double time_s = 0.01 * row;
        velocities += dfdyn::tools::number_text(time_s);
        for (const double value : {std::sin(time_s), std::cos(time_s), std::cos(time_s), -std::sin(time_s),
                                   std::sin(2 * time_s), std::cos(2 * time_s)}) {
            velocities += "," + dfdyn::tools::number_text(value);
        }
        velocities += "\n";
    }
    std::ofstream(bench.path("velocities.csv")) << velocities;
    check_refused(bench.call("train --log " + bench.path("velocities.csv") +
                             " --outputs tau --input STD --derivatives measured -o " +
                             bench.path("model.json")),
                  "for measured derivatives, found qd1…qd2, but no qdd1…qdd2");
}

TEST_CASE("a replay of an unsuitable recording is rejected with one line") {
    const Bench bench;
    REQUIRE(bench.train(robot + "--outputs tau --model SP --input STD --derivatives measured").status == 0);
    CHECK(bench.replay(bench.path("run.csv")).status == 0);
    check_refused(
        bench.replay(bench.path("positions.csv")),
        "expected columns qd1… and qdd1…, whose derivatives the model was trained with, found none");
    check_refused(
        bench.replay(DFDYN_TEST_DATA_DIR "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv"),
        "expected 2 joint positions, as the chain has joints, found 6");
    REQUIRE(bench.train(robot + "--outputs tau --model SP --input STD --derivatives estimated").status == 0);
    CHECK(bench.replay(bench.path("positions.csv")).status == 0);
}

TEST_CASE("several models of the same arm are replayed as one combination") {
    const Bench bench;
    const std::string start = robot + "--outputs tau --input DFR ";
    REQUIRE(bench.train(start + "--model NP").status == 0);
    REQUIRE(bench.train(start + "--model P --effects viscous_friction", "other.json").status == 0);
    const std::string both = bench.path("model.json") + "," + bench.path("other.json");
    const std::string on_log = " --log " + bench.path("run.csv") + " --rows 300:";
    const Outcome combined = bench.call("replay --model " + both + on_log);
    REQUIRE(combined.status == 0);
    CHECK_THAT(combined.out, ContainsSubstring("model: NP, input DFR") && ContainsSubstring("; P, input "));
    const double error = largest_figure(combined.out, "nRMSE, second half");
    for (const char* const name : {"model.json", "other.json"}) {
        const Outcome one = bench.call("replay --model " + bench.path(name) + on_log);
        CHECK(error > 0);
        CHECK(error < 1.2 * largest_figure(one.out, "nRMSE, second half"));
    }
    check_refused(
        bench.call("replay --model " + bench.path("model.json") + "," + bench.path("none.json") + on_log),
        "cannot be read as a model");
    REQUIRE(bench.train("--outputs wrench --model NP", "wrench.json").status == 0);
    check_refused(
        bench.call("replay --model " + bench.path("model.json") + "," + bench.path("wrench.json") + on_log),
        "expected joints and outputs as in ");
    nlohmann::json slow = bench.model();
    slow["sample_period_s"] = 2 * slow["sample_period_s"].get<double>();
    bench.write("slow.json", slow.dump());
    check_refused(
        bench.call("replay --model " + bench.path("model.json") + "," + bench.path("slow.json") + on_log),
        "expected the sample period of ");
}

/// The recording with the outputs tau1 and tau2 in reverse order of rows and everything else unchanged.
std::string with_reversed_outputs(const std::string& csv) {
    std::istringstream lines(csv);
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        rows.emplace_back();
        for (std::string field; std::getline(fields, field, ',');) {
            rows.back().push_back(field);
        }
    }
    std::string result;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        for (std::size_t column = 0; column < rows[row].size(); ++column) {
            const bool output = rows[0][column].starts_with("tau");
            const std::size_t from = output && row > 0 ? rows.size() - row : row;
            result.append(column == 0 ? "" : ",").append(rows[from][column]);
        }
        result.append("\n");
    }
    return result;
}

TEST_CASE("the predictions of a frozen replay do not depend on measured outputs") {
    const Bench bench;
    REQUIRE(bench.train("--outputs tau --model SPK --input DFSR" + robot).status == 0);
    const std::string reversed = with_reversed_outputs(file_content(bench.path("run.csv")));
    bench.write("reversed.csv", reversed);
    const auto predictions = [&bench](const std::string& log, const std::string& options) {
        const Outcome outcome = bench.replay(bench.path(log), options + " -o " + bench.path("out.csv"));
        CAPTURE(outcome.error);
        REQUIRE(outcome.status == 0);
        CHECK((outcome.out.find(" 0 learned") != std::string::npos) == (options == "--frozen"));
        return without_columns(file_content(bench.path("out.csv")), [](const std::string& name) {
            return !name.ends_with("_pred") && !name.ends_with("_std");
        });
    };
    const std::string frozen = predictions("run.csv", "--frozen");
    CHECK(predictions("reversed.csv", "--frozen") == frozen);
    CHECK(predictions("run.csv", "") != frozen);
}

TEST_CASE("training on outputs that are only noise says that the features explain hardly anything") {
    const TemporaryDirectory directory;
    std::mt19937 engine(3);
    std::normal_distribution<double> noise;
    std::ostringstream csv("t,q1,q2,tau1,tau2\n", std::ios::ate);
    for (int row = 0; row < 1500; ++row) {
        const double time_s = 0.01 * row;
        csv << time_s << ',' << std::sin(time_s) << ',' << std::cos(1.7 * time_s) << ',' << noise(engine)
            << ',' << noise(engine) << '\n';
    }
    directory.write("noise.csv", csv.str());
    const auto outcome = run_program(
        directory, "train --outputs tau --features 10 --starts 1 --likelihood-rows 200 --quiet --log " +
                       (directory.path() / "noise.csv").string() + " -o " +
                       (directory.path() / "model.json").string());
    CHECK(outcome.status == 0);
    CHECK_THAT(outcome.out, ContainsSubstring("the features explain hardly anything"));
}

} // namespace model_commands_test
