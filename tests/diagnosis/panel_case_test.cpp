// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_case.hpp"

#include "tests/diagnosis/panel/recording/panel_files.hpp"
#include "tests/diagnosis/panel/recording/panel_run.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace {

using namespace dfdyn::tests;
using namespace dfdyn::tools;

/// Root mean square below 5 Hz from the spectrum, weighted like a second-order Butterworth low pass applied
/// twice.
double spectral_rms(const Eigen::VectorXd& signal, double rate_hz) {
    const auto count = static_cast<double>(signal.size());
    double power = 0;
    for (int line = 0; line * rate_hz / count < 20; ++line) {
        std::complex<double> sum = 0;
        std::complex<double> turned = 1;
        const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * line / count);
        for (const double value : signal) {
            sum += value * turned;
            turned *= turn;
        }
        const double weight = 1 / (1 + std::pow(line * rate_hz / count / 5, 4));
        power += (line == 0 ? 1 : 2) * std::norm(weight * sum / count);
    }
    return std::sqrt(power);
}

Eigen::VectorXd output(const PanelCase& panel_case, const std::string& name) {
    const Columns& columns = panel_case.recording.output;
    const auto column =
        static_cast<std::size_t>(std::ranges::find(columns.names, name) - columns.names.begin());
    Eigen::VectorXd result(static_cast<Eigen::Index>(panel_case.recording.row_count()));
    for (Eigen::Index row = 0; row < result.size(); ++row) {
        result[row] = columns.row(static_cast<std::size_t>(row))[column];
    }
    return result;
}

PanelMix only(const std::string& effect, double strength) {
    PanelMix mix;
    mix.effect = effect;
    mix.strength = strength;
    return mix;
}

} // namespace

TEST_CASE(
    "the strength of a sensor effect equals the ratio of the spectra of the difference and of the noise") {
    // These effects do not change the motion: recordings with and without them differ by the effect alone.
    const std::pair<const char*, const char*> cases[] = {
        {"torque_offset", "ur5_torque"}, {"ft_gain", "icub_wrench"}, {"delay", "three_joint_torque"}};
    for (const auto& [effect, robot] : cases) {
        for (const double strength : {0.3, 3.0}) {
            PanelMix mix = only(effect, strength);
            mix.robot = robot;
            const PanelCase with = make_panel_case(seed(), mix);
            mix.effect.reset();
            mix.null_share = 1;
            const PanelCase without = make_panel_case(seed(), mix);
            CAPTURE(effect, strength);
            REQUIRE(without.hidden.empty());
            REQUIRE(with.hidden.size() == 1);
            const std::string main_output = with.hidden[0].main_output;
            const PanelSetup setup = make_panel_setup(seed(), mix);
            Eigen::Index column = 0;
            while (setup.output_name(column) != main_output) {
                ++column;
            }
            const double rate_hz = setup.scenario.recording.rate_hz;
            const double reached =
                spectral_rms(output(with, main_output) - output(without, main_output), rate_hz) /
                spectral_rms(setup.noise_rows.col(column), rate_hz);
            CHECK(reached == Approx(with.hidden[0].strength).epsilon(0.05));
            CHECK(with.hidden[0].strength == Approx(strength).epsilon(0.15));
            CHECK(with.hidden[0].effect == effect);
        }
    }
}

TEST_CASE("the same seed gives the same bytes and another seed gives others") {
    const TemporaryDirectory directory;
    const auto bytes = [&](std::uint64_t case_seed, const std::string& name) {
        write_panel_case(make_panel_case(case_seed), directory.path(), name);
        return read_file(directory.path() / (name + ".csv"), "") +
               read_file(directory.path() / (name + ".truth.json"), "");
    };
    const std::string first = bytes(seed(), "a");
    CHECK(first == bytes(seed(), "b"));
    CHECK(first != bytes(seed() + 1, "c"));
    const nlohmann::json truth = nlohmann::json::parse(read_file(directory.path() / "a.truth.json", ""));
    CHECK(truth.at("schema") == "dfdyn.panel_truth/1");
    CHECK(truth.at("seed") == seed());
}

TEST_CASE("a recording has only finite positions and outputs of equal length within the joints' limits") {
    for (const std::string& robot : panel_robot_names()) {
        PanelMix mix;
        mix.robot = robot;
        mix.null_share = 1;
        const PanelCase panel_case = make_panel_case(seed(), mix);
        const Recording& recording = panel_case.recording;
        CAPTURE(robot);
        REQUIRE(recording.row_count() * recording.joint_count() == recording.position.values.size());
        REQUIRE(recording.row_count() * recording.output.names.size() == recording.output.values.size());
        CHECK_FALSE(recording.velocity.present());
        CHECK_FALSE(recording.acceleration.present());
        const double lasts = recording.time_s.back() - recording.time_s.front();
        CHECK((lasts > 39 && lasts < 61));
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
                const RobotJoint& limits = panel_case.nominal.joints[joint];
                REQUIRE(recording.position.row(row)[joint] < limits.upper.value_or(1e3));
                REQUIRE(recording.position.row(row)[joint] > limits.lower.value_or(-1e3));
            }
        }
    }
}

TEST_CASE("nominal masses are exact or wrong by up to 10 % with all parameters of a link scaled alike") {
    PanelMix mix;
    mix.null_share = 1;
    mix.robot = "icub_wrench";
    mix.masses_off = true;
    const PanelCase off = make_panel_case(seed(), mix);
    mix.masses_off = false;
    const PanelCase exact = make_panel_case(seed(), mix);
    for (std::size_t link = 0; link < off.nominal.joints.size(); ++link) {
        const InertialParameters& wrong = off.nominal.joints[link].inertia;
        const InertialParameters& right = exact.nominal.joints[link].inertia;
        CHECK(std::abs(off.mass_errors[link]) <= 0.1);
        CHECK((wrong - (1 + off.mass_errors[link]) * right).norm() < 1e-12);
        CHECK(exact.mass_errors[link] == 0);
    }
    CHECK(off.recording.output.values == exact.recording.output.values);
}

TEST_CASE("every effect of the catalogue can be hidden") {
    const std::vector<std::string> hidden = panel_effect_names(true);
    for (const Effect& effect : effect_catalogue()) {
        CAPTURE(effect.name);
        CHECK(std::ranges::count(hidden, effect.name) == 1);
    }
    CHECK(std::ranges::count(hidden, "greased_backlash") == 1); // backlash, simulated in another way
    CHECK(hidden.size() == effect_catalogue().size() + 1);
}

TEST_CASE("unknown names and effects that the outputs cannot show are rejected") {
    CHECK_THROWS_AS(make_panel_case(1, only("gremlins", 1)), InputError);
    PanelMix mix = only("viscous_friction", 1);
    mix.robot = "icub_wrench";
    CHECK_THROWS_WITH(make_panel_case(1, mix), Catch::Matchers::ContainsSubstring("shows on the outputs"));
    mix = {};
    mix.robot = "toaster";
    CHECK_THROWS_AS(make_panel_case(1, mix), InputError);
}

TEST_CASE("the residuals of the real recording's regression are coloured noise at every joint") {
    const auto& residuals = real_residuals();
    REQUIRE(residuals.size() == 6);
    for (const std::vector<double>& series : residuals) {
        double squares = 0;
        double neighbours = 0;
        for (std::size_t row = 1; row < series.size(); ++row) {
            squares += series[row] * series[row];
            neighbours += series[row] * series[row - 1];
        }
        CHECK(series.size() > 9000);
        CAPTURE(neighbours / squares);
        CHECK(neighbours / squares > 0.2); // 0.01 for white noise
        CHECK(neighbours / squares < 0.999);
    }
}
