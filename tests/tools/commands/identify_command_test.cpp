// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/csv_writer.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/robot/arms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace identify_command_test {

namespace tools = dfdyn::tools;

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string arm =
    " --robot " DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf --base chest --tip r_hand ";

Outcome identify(const TemporaryDirectory& directory, const std::string& arguments) {
    return run_program(directory, "identify " + arguments);
}

/// 20 s at 100 Hz in which each joint swings with two frequencies about the middle of its range.
tools::RobotMotion swinging(const tools::Robot& robot) {
    const Eigen::Index rows = 2000;
    tools::RobotMotion motion{Eigen::MatrixXd(rows, 4), Eigen::MatrixXd::Zero(rows, 4),
                              Eigen::MatrixXd::Zero(rows, 4)};
    for (Eigen::Index i = 0; i < 4; ++i) {
        const tools::RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        const double reach = 0.45 * (*joint.upper - *joint.lower);
        motion.position.col(i).setConstant(0.5 * (*joint.upper + *joint.lower));
        for (const auto& [part, rate] :
             {std::pair{0.6, 1.0 + 0.3 * double(i)}, std::pair{0.4, 3.1 - 0.4 * double(i)}}) {
            for (Eigen::Index t = 0; t < rows; ++t) {
                const double phase = rate * 0.01 * double(t) + double(i);
                motion.position(t, i) += part * reach * std::sin(phase);
                motion.velocity(t, i) += part * reach * rate * std::cos(phase);
                motion.acceleration(t, i) -= part * reach * rate * rate * std::sin(phase);
            }
        }
    }
    return motion;
}

/// The sensor's recording if all links are heavier by `factor`.
std::string recording(double factor, bool with_derivatives) {
    const tools::Robot robot = dfdyn::tests::icub_right_arm();
    const tools::RobotMotion motion = swinging(robot);
    const Eigen::MatrixXd wrench =
        tools::unstacked(tools::stacked_regressor(robot, tools::OutputKind::wrench, motion) * factor *
                             tools::nominal_parameters(robot, tools::OutputKind::wrench),
                         6);
    std::vector<std::string> columns{"t", "q1", "q2", "q3", "q4", "fx", "fy", "fz", "mx", "my", "mz"};
    if (with_derivatives) {
        columns.insert(columns.end(), {"qd1", "qd2", "qd3", "qd4", "qdd1", "qdd2", "qdd3", "qdd4"});
    }
    std::ostringstream text;
    tools::CsvWriter writer(text, columns);
    for (Eigen::Index t = 0; t < motion.rows(); ++t) {
        writer.field(0.01 * double(t));
        for (const auto* part : {&motion.position, &wrench, &motion.velocity, &motion.acceleration}) {
            if (with_derivatives || part == &motion.position || part == &wrench) {
                const Eigen::VectorXd row = part->row(t);
                writer.fields(std::span(row.data(), static_cast<std::size_t>(row.size())));
            }
        }
        writer.end_row();
    }
    return text.str();
}

TEST_CASE("identify finds the true parameters of an arm with and without recorded derivatives") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    directory.write("full.csv", recording(1.1, true));
    directory.write("positions.csv", recording(1.1, false));
    for (const std::string log : {"full", "positions"}) {
        CAPTURE(log);
        const Outcome outcome =
            identify(directory, arm + "--log " + in + "/" + log +
                                    ".csv --outputs wrench --consistent --half-width 3 -o " + in + "/p.json");
        CAPTURE(outcome.error);
        REQUIRE(outcome.status == 0);
        CHECK_THAT(outcome.out, ContainsSubstring("r_arm_ft_sensor") &&
                                    ContainsSubstring("1.93226 kg beyond") &&
                                    ContainsSubstring("17 base parameters of 20"));
        const auto json = nlohmann::json::parse(file_content(directory.path() / "p.json"));
        CHECK(json["schema"] == "dfdyn.parameters/1");
        CHECK(json["outputs"][5] == "mz");
        REQUIRE(json["base_parameters"].size() == 17);
        int determined = 0;
        for (const auto& parameter : json["base_parameters"]) {
            if (parameter["determined"]) {
                ++determined;
                const double nominal = parameter["nominal"];
                CHECK(parameter["value"] == Approx(1.1 * nominal).margin(2e-4));
            }
        }
        CHECK(determined >= 10);
        CHECK(json["rms_fitted"][0] < 0.01 * double(json["rms_nominal"][0]));
        REQUIRE(json["bodies"].size() == 2);
        CHECK(json["bodies"][1]["link"] == "r_elbow_1");
        CHECK(double(json["bodies"][0]["mass"]) + double(json["bodies"][1]["mass"]) ==
              Approx(1.1 * 1.9322575).epsilon(1e-2));
    }
}

TEST_CASE("identify rejects unusable input with one line") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string log =
        "--log " + directory
                       .write("short.csv", "t,q1,q2,q3,q4,fx,fy,fz,mx,my,mz\n"
                                           "0,0,0,0,0,0,0,0,0,0,0\n0.002,0,0,0,0,0,0,0,0,0,0\n")
                       .string();
    const std::string no_sensor = " --robot " DFDYN_TEST_DATA_DIR "/robots/ur5/ur5_robot.urdf --tip ee_link ";
    const std::string cases[] = {
        "",
        arm + log,
        arm + log + " --outputs i",
        arm + log + " --outputs tau",
        arm + log + " --outputs wrench",
        arm + log + " --outputs wrench --half-width 1 --degree 5",
        arm + log + " --outputs wrench --gravity 1,2",
        arm + log + " --outputs wrench --wrench-direction up",
        arm + log + " --outputs wrench --ft-joint r_elbow",
        arm + "--log none.csv --outputs wrench",
        no_sensor + log + " --outputs wrench",
        " --robot none.urdf --tip x " + log + " --outputs wrench",
        " --robot " + in + "/short.csv --tip x " + log + " --outputs wrench",
    };
    for (const std::string& arguments : cases) {
        CAPTURE(arguments);
        const Outcome outcome = identify(directory, arguments);
        CHECK(outcome.status == 2);
        CHECK(outcome.out.empty());
        CHECK(std::ranges::count(outcome.error, '\n') == 1);
        CHECK_THAT(outcome.error, ContainsSubstring("dfdyn: "));
    }
    CHECK_THAT(identify(directory, "--help").out, ContainsSubstring("Example:"));
}

} // namespace identify_command_test
