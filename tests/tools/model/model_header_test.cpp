// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/header/header_text.hpp"
#include "tools/model/header/model_header.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/contact_constants.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <sstream>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::file_content;
using dfdyn::tests::small_model;
using dfdyn::tests::small_physics_model;
using dfdyn::tests::TemporaryDirectory;

/// A program that runs the estimator of the header over a fixed motion and prints all predictions and
/// deviations.
constexpr const char* program = R"(
#include "m.hpp"
#include <cstdio>
static dfdyn::Estimator<m::Model> estimator(m::constants);
void set_derivatives([[maybe_unused]] auto& sample, [[maybe_unused]] int t) {
    if constexpr (requires { sample.velocity; }) {
        for (int i = 0; i < 2; ++i) sample.velocity[i] = static_cast<float>(((t * (3 + i)) % 11) / 8.0);
        for (int i = 0; i < 2; ++i) sample.acceleration[i] = static_cast<float>(((t * (5 + i)) % 13) / 4.0);
    }
}
int main() {
    for (int t = 0; t < 40; ++t) {
        decltype(estimator)::Sample sample{};
        sample.time_ns = 4000000LL * t;
        sample.output_valid = true;
        for (int i = 0; i < 2; ++i) sample.position[i] = static_cast<float>(((t * (7 + 5 * i)) % 23) / 16.0);
        set_derivatives(sample, t);
        for (int k = 0; k < m::Model::outputs; ++k) sample.output[k] = static_cast<float>(((t * (3 + k)) % 17) / 8.0 - 1);
        const auto estimate = estimator.tick(sample, dfdyn::Budget::unlimited());
        for (int k = 0; k < m::Model::outputs; ++k)
            std::printf("%a %a\n", static_cast<double>(estimate.prediction[k]),
                        static_cast<double>(estimate.standard_deviation[k]));
    }
}
)";

std::vector<double> run_header(const TemporaryDirectory& directory, const TrainedModel& model) {
    directory.write("m.hpp", model_to_header(model, "m"));
    const std::string source = directory.write("main.cpp", program);
    const std::string binary = directory.path() / "main";
    const std::string output = directory.path() / "out.txt";
    const std::string compile = std::string(DFDYN_CXX) +
                                " -std=c++20 -O1 -Wall -Wextra -Wpedantic -Wconversion -Werror" +
                                " -fno-exceptions -fno-rtti -I " DFDYN_FIRMWARE_INCLUDE " " + source +
                                " -o " + binary + " && " + binary + " > " + output;
    REQUIRE(std::system(compile.c_str()) == 0);
    std::istringstream text(file_content(output));
    std::vector<double> values;
    for (std::string word; text >> word;) {
        values.push_back(std::strtod(word.c_str(), nullptr));
    }
    return values;
}

std::vector<double> run_host(const TrainedModel& model) {
    const auto estimator = make_estimator(model, false);
    const std::size_t outputs = model.outputs.names.size();
    std::vector<double> values;
    for (int t = 0; t < 40; ++t) {
        std::array<double, 2> position{};
        std::array<double, 2> velocity{};
        std::array<double, 2> acceleration{};
        std::array<double, 6> output{};
        for (int i = 0; i < 2; ++i) {
            const auto joint = static_cast<std::size_t>(i);
            position[joint] = ((t * (7 + 5 * i)) % 23) / 16.0;
            velocity[joint] = ((t * (3 + i)) % 11) / 8.0;
            acceleration[joint] = ((t * (5 + i)) % 13) / 4.0;
        }
        for (int k = 0; k < 6; ++k) {
            output[static_cast<std::size_t>(k)] = ((t * (3 + k)) % 17) / 8.0 - 1;
        }
        const Tick tick = estimator->tick(
            {4000000LL * t, position, velocity, acceleration, std::span(output).first(outputs)});
        for (std::size_t k = 0; k < outputs; ++k) {
            values.push_back(static_cast<double>(tick.prediction[k]));
            values.push_back(static_cast<double>(tick.standard_deviation[k]));
        }
    }
    return values;
}

/// Compares the predictions and deviations of the header with those of the model file. Builds with different
/// flags may differ in rounding by a few units in the last place per operation.
void check_header(const TrainedModel& written) {
    const TrainedModel model = model_from_json(model_to_json(written), "m.json");
    const TemporaryDirectory directory;
    const std::vector<double> embedded = run_header(directory, model);
    const std::vector<double> host = run_host(model);
    REQUIRE(embedded.size() == host.size());
    for (std::size_t i = 0; i < host.size(); ++i) {
        CAPTURE(i);
        CHECK((embedded[i] == host[i] || std::abs(embedded[i] - host[i]) < 1e-3 * (1 + std::abs(host[i]))));
    }
}

} // namespace

TEST_CASE("the header compiles without exceptions and predicts as the model file does") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const InputKind kind : dfdyn::tests::all_inputs()) {
        CAPTURE(input_description(kind).name);
        check_header(small_model(engine, kind));
    }
}

TEST_CASE("the header of a model with physics predicts as the model file does") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const bool wrench : {false, true}) {
        for (const char* structure : {"P", "SP", "SPK"}) {
            CAPTURE(structure, wrench);
            check_header(small_physics_model(engine, structure, InputKind::DFR, wrench));
        }
    }
    check_header(small_physics_model(engine, "SPK", InputKind::STD, true));
}

TEST_CASE("the header contains the extrapolation data of the model file") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    const std::vector<double> without = run_host(model);
    dfdyn::tests::add_extrapolation(model, engine);
    CHECK(run_host(model) != without);
    check_header(model);
    TrainedModel with_physics = small_physics_model(engine, "SPK", InputKind::DFR, false);
    dfdyn::tests::add_extrapolation(with_physics, engine);
    check_header(with_physics);
    const std::vector<double> once = run_host(with_physics);
    with_physics.extrapolation->parameter_variance_factor = 500;
    with_physics.extrapolation->output_variance = {3, 4};
    CHECK(run_host(with_physics) != once);
    check_header(with_physics);
}

TEST_CASE("the header has the amplitude of the features to the last bit") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    TrainedModel model = small_model(engine, InputKind::DF);
    model.features.count = 7; // 1 / sqrt(7) is rounded differently in single and in double precision
    model.features.omega = dfdyn::tests::numbers(engine, 7 * 2 * 5, normal);
    const auto host = make_host_constants<HostNonparametric>(model, false);
    CHECK(model_to_header(model, "m").find(".amplitude = " + literal(host->constants.features.amplitude)) !=
          std::string::npos);
}

TEST_CASE("the header has the limits of contacts that the program uses, if the model has them") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DF);
    CHECK(model_to_header(model, "m").find("contact_limits") == std::string::npos);
    model.contact = {.limit = {1, 2, 3, 4, 5, 6.1},
                     .usual = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6},
                     .speed = {0.7, 8},
                     .standard_deviation = {0.9, 2.5},
                     .hysteresis = {0, 0.35}};
    const std::string header = model_to_header(model, "m");
    for (const dfdyn::ContactLimits<float>& joint : contact_constants(model.contact)) {
        CHECK(header.find("{.limit = " + array(joint.limit) + ", .usual = " + literal(joint.usual) +
                          ", .relative = " + literal(joint.relative) + ", .speed = " + literal(joint.speed) +
                          ", .acceleration = " + literal(joint.acceleration) +
                          ", .standard_deviation = " + literal(joint.standard_deviation) +
                          ", .hysteresis = " + literal(joint.hysteresis) + "}") != std::string::npos);
    }
}

TEST_CASE("hostile names do not escape from their comment") {
    std::mt19937_64 engine(1);
    TrainedModel model = small_model(engine, InputKind::DF);
    model.training.recordings = {"a\nint x;\\"};
    const std::string header = model_to_header(model, "m");
    CHECK(header.find("\nint x;") == std::string::npos);
    CHECK(header.find("a?int x;?") != std::string::npos);
}

TEST_CASE("any file stem becomes a valid identifier") {
    CHECK(to_identifier("model") == "model");
    CHECK(to_identifier("my-arm 2") == "my_arm_2");
    CHECK(to_identifier("2dof") == "model_2dof");
    CHECK(to_identifier("") == "model_");
    CHECK(to_identifier("1-mödel") == "model_1_m__del");
    for (const std::string taken : {"class", "int", "co_await", "xor_eq", "dfdyn", "std"}) {
        CHECK(to_identifier(taken) == taken + "_");
    }
    CHECK(to_identifier("classes") == "classes");
}
