// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <utility>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::all_inputs;
using dfdyn::tests::numbers;
using dfdyn::tests::small_model;
using dfdyn::tests::small_physics_model;

/// The error message for `text`, or nothing if it is a valid model.
std::optional<std::string> refusal(const std::string& text) {
    try {
        model_from_json(text, "m.json");
        return std::nullopt;
    } catch (const InputError& error) {
        return error.what();
    }
}

/// The error message for a valid model of input DFR in which the field at `pointer` is replaced.
std::optional<std::string> refusal_with(const std::string& pointer, const nlohmann::json& value) {
    std::mt19937_64 engine(1);
    nlohmann::json json = nlohmann::json::parse(model_to_json(small_model(engine, InputKind::DFR)));
    json[nlohmann::json::json_pointer(pointer)] = value;
    return refusal(json.dump());
}

} // namespace

TEST_CASE("a model of a recording whose name is not UTF-8 reads back") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    model.training.recordings = {"Pr\xfc"
                                 "fung.csv"};
    const TrainedModel read = model_from_json(model_to_json(model), "m.json");
    CHECK(read.training.recordings == std::vector<std::string>{"Pr\uFFFDfung.csv"});
}

TEST_CASE("a model with physics of any structure reads back") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const char* structure : {"P", "SP", "SP2", "SPK"}) {
        for (const bool wrench : {false, true}) {
            for (const InputKind kind : all_inputs()) {
                CAPTURE(structure, wrench, input_description(kind).name);
                const std::string text = model_to_json(small_physics_model(engine, structure, kind, wrench));
                CHECK(model_to_json(model_from_json(text, "m.json")) == text);
            }
        }
    }
}

TEST_CASE("a model keeps the rigid bodies that it is compared with and older files have none") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_physics_model(engine, "P", InputKind::DFR, false);
    CHECK(model_from_json(model_to_json(model), "m.json").physics->rigid_body.empty());
    std::normal_distribution<double> normal;
    for (const bool identified : {false, true}) {
        model.physics->rigid_body.push_back({identified, 0.05, numbers(engine, 2, normal),
                                             numbers(engine, 20, normal), numbers(engine, 6, normal)});
    }
    const std::string text = model_to_json(model);
    const TrainedModel read = model_from_json(text, "m.json");
    REQUIRE(read.physics->rigid_body.size() == 2);
    CHECK(read.physics->rigid_body[1].identified);
    CHECK(read.physics->rigid_body[1].inertia == model.physics->rigid_body[1].inertia); // in double precision
    CHECK(model_to_json(read) == text);
    nlohmann::json wrong = nlohmann::json::parse(text);
    wrong["physics"]["rigid_body"][0]["friction"].erase(0);
    CHECK_THAT(refusal(wrong.dump()).value(),
               Catch::Matchers::StartsWith("m.json: physics.rigid_body[0].friction: expected"));
}

TEST_CASE("an impossible model with physics is rejected") {
    std::mt19937_64 engine(1);
    const nlohmann::json good =
        nlohmann::json::parse(model_to_json(small_physics_model(engine, "SPK", InputKind::DFR, false)));
    const auto refusal_of = [&](const char* pointer, const nlohmann::json& value) {
        nlohmann::json json = good;
        json[nlohmann::json::json_pointer(pointer)] = value;
        return refusal(json.dump()).value_or("accepted");
    };
    using Catch::Matchers::StartsWith;
    CHECK_THAT(refusal_of("/physics/selected/1", 1),
               StartsWith("m.json: physics.selected: expected ascending"));
    CHECK_THAT(refusal_of("/physics/selected/8", 26), StartsWith("m.json: physics.selected: expected"));
    CHECK_THAT(refusal_of("/physics/column_scale/0", 0), StartsWith("m.json: physics.column_scale"));
    CHECK_THAT(refusal_of("/physics/effects/0/effect", "magic"),
               StartsWith("m.json: physics.effects[0].effect: expected one of"));
    CHECK_THAT(refusal_of("/physics/effects/0/effect", "ft_bias"),
               StartsWith("m.json: physics.effects[0].effect: expected an effect on joint torques"));
    CHECK_THAT(refusal_of("/physics/effects/2/sign_velocity", 0),
               StartsWith("m.json: physics.effects[2].sign_velocity: expected a positive"));
    CHECK_THAT(refusal_of("/physics/effects/4/cycles_per_rev", 0),
               StartsWith("m.json: physics.effects[4].cycles_per_rev: expected a positive"));
    CHECK_THAT(refusal_of("/physics/chain/joints/1/axis", {1, 1, 0}),
               StartsWith("m.json: physics.chain.joints[1].axis: expected a vector of length 1"));
    CHECK_THAT(refusal_of("/physics/chain/joints/0/placement/rotation/0", 2),
               StartsWith("m.json: physics.chain.joints[0].placement.rotation: expected a rotation"));
    CHECK_THAT(refusal_of("/physics/coupling", {1, 2}), StartsWith("m.json: physics.coupling"));
    CHECK_THAT(refusal_of("/physics/prior_variance", -1), StartsWith("m.json: physics.prior_variance"));
    CHECK_THAT(refusal_of("/forgetting_factor", 0.8), StartsWith("m.json: forgetting_factor"));
    CHECK_THAT(refusal_of("/structure", "SPQ"), StartsWith("m.json: structure: expected one of NP, P, SP"));
}

TEST_CASE("a model reads back bit for bit in single precision") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const InputKind kind : all_inputs()) {
        CAPTURE(input_description(kind).name);
        const TrainedModel written = small_model(engine, kind);
        const std::string text = model_to_json(written);
        const TrainedModel read = model_from_json(text, "m.json");
        CHECK(model_to_json(read) == text);
        CHECK(read.input.kind == kind);
        CHECK(read.input.rows == written.input.rows);
        REQUIRE(read.start.unit_upper.size() == written.start.unit_upper.size());
        for (std::size_t i = 0; i < read.start.unit_upper.size(); ++i) {
            CHECK(static_cast<float>(read.start.unit_upper[i]) ==
                  static_cast<float>(written.start.unit_upper[i]));
        }
        CHECK(model_identity(read) == model_identity(written));
    }
}

TEST_CASE("the extrapolation data of a model read back and a model without them stays without") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    CHECK_FALSE(model_from_json(model_to_json(model), "m.json").extrapolation.has_value());
    const auto identity = model_identity(model);
    dfdyn::tests::add_extrapolation(model, engine);
    const std::string text = model_to_json(model);
    CHECK(model_to_json(model_from_json(text, "m.json")) == text);
    CHECK(model_identity(model) != identity);
    model.extrapolation->extra_noise[1] = -0.5;
    CHECK(refusal(model_to_json(model)) ==
          "m.json: extrapolation.extra_noise: expected numbers of at least 0, found \"-0.5\"");
    model.extrapolation->extra_noise[1] = 0;
    model.extrapolation->inverse_far_variance = 0;
    CHECK(refusal(model_to_json(model)).has_value());
}

TEST_CASE("the limits of contacts read back, also those of older files without a rate") {
    std::mt19937_64 engine(1);
    TrainedModel model = small_model(engine, InputKind::DFSR);
    const std::size_t outputs = model.outputs.names.size();
    model.contact.limit.assign(3 * outputs, 1.5);
    model.contact.usual.assign(3 * outputs, 0.25);
    CHECK(model_to_json(model).find("rate_slope") == std::string::npos);
    CHECK(model_from_json(model_to_json(model), "m.json").contact.standard_deviation.empty());
    CHECK(model_from_json(model_to_json(model), "m.json").contact.rate_slope == 0);
    model.contact.relative.assign(outputs, 0.5);
    model.contact.speed.assign(outputs, 2);
    model.contact.acceleration.assign(outputs, 8);
    model.contact.rate_slope = 0.125;
    model.contact.standard_deviation.assign(outputs, 0.75);
    CHECK(model_from_json(model_to_json(model), "m.json").contact.hysteresis.empty());
    model.contact.hysteresis.assign(outputs, 0.375);
    const ContactModel read = model_from_json(model_to_json(model), "m.json").contact;
    CHECK(read.limit == model.contact.limit);
    CHECK(read.usual == model.contact.usual);
    CHECK(read.relative == model.contact.relative);
    CHECK(read.speed == model.contact.speed);
    CHECK(read.acceleration == model.contact.acceleration);
    CHECK(read.rate_slope == model.contact.rate_slope);
    CHECK(read.standard_deviation == model.contact.standard_deviation);
    CHECK(read.hysteresis == model.contact.hysteresis);
    model.contact.relative[1] = -0.5;
    CHECK(refusal(model_to_json(model)) ==
          "m.json: contact.relative: expected numbers of at least 0, found \"-0.5\"");
}

TEST_CASE("the prediction limits of a model read back and a model without them is unchanged") {
    std::mt19937_64 engine(1);
    TrainedModel model = small_model(engine, InputKind::DFR);
    const auto without = model_identity(model);
    CHECK(model_to_json(model).find("\"prediction\"") == std::string::npos);
    CHECK(model_from_json(model_to_json(model), "m.json").limits.prediction.empty());
    model.limits.prediction.assign(model.outputs.names.size(), 7.5);
    CHECK(model_from_json(model_to_json(model), "m.json").limits.prediction == model.limits.prediction);
    CHECK(model_identity(model) != without);
    CHECK(refusal_with("/limits/prediction", {1, -1}).has_value());
}

TEST_CASE("the parameter uncertainty of a model reads back and without it the variance counts once") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const char* structure : {"P", "SPK"}) {
        CAPTURE(structure);
        TrainedModel model = dfdyn::tests::small_physics_model(engine, structure, InputKind::DFR, false);
        dfdyn::tests::add_extrapolation(model, engine);
        if (model.structure == "P") {
            model.extrapolation->inverse_far_variance = 0;
            model.extrapolation->prior_variance = {0, 0};
        }
        CHECK(model_from_json(model_to_json(model), "m.json").extrapolation->output_variance.empty());
        model.extrapolation->parameter_variance_factor = 500;
        model.extrapolation->output_variance = {3, 4};
        const std::string text = model_to_json(model);
        const TrainedModel read = model_from_json(text, "m.json");
        CHECK(model_to_json(read) == text);
        CHECK(read.extrapolation->parameter_variance_factor == 500);
        model.extrapolation->parameter_variance_factor = 0.5;
        CHECK(refusal(model_to_json(model)).has_value());
        model.extrapolation->parameter_variance_factor = 500;
        model.extrapolation->output_variance = {3, 0};
        CHECK(refusal(model_to_json(model)).has_value());
    }
}

TEST_CASE("models that differ in one number have different identities") {
    std::mt19937_64 engine(1);
    TrainedModel model = small_model(engine, InputKind::DFR);
    const auto identity = model_identity(model);
    model.features.omega.back() += 1e-3;
    CHECK(model_identity(model) != identity);
}

TEST_CASE("what a model has learned is that of the model with other limits of contacts, too") {
    std::mt19937_64 engine(1);
    TrainedModel model = small_model(engine, InputKind::DFR);
    const auto identity = model_identity(model);
    model.contact.limit.assign(3 * model.outputs.names.size(), 2.5);
    model.contact.usual.assign(3 * model.outputs.names.size(), 0.5);
    CHECK(model_identity(model) == identity);
}

TEST_CASE("every truncation of a model file is rejected with one line") {
    std::mt19937_64 engine(1);
    const std::string text = model_to_json(small_model(engine, InputKind::DFSR));
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {
        const auto message = refusal(text.substr(0, length));
        REQUIRE(message);
        REQUIRE_THAT(*message, Catch::Matchers::StartsWith("m.json: "));
        REQUIRE(message->find('\n') == std::string::npos);
    }
}

TEST_CASE("an error in a model is reported with the field and the expected and the found value") {
    const std::pair<std::pair<std::string, nlohmann::json>, std::string> cases[] = {
        {{"/schema", "dfdyn.model/2"}, "m.json: schema: expected \"dfdyn.model/1\", found \"dfdyn.model/2\""},
        {{"/structure", "XP"}, "m.json: structure: expected one of NP, P, SP, SP2, SPK, found \"XP\""},
        {{"/joints", 0}, "m.json: joints: expected a whole number from 1 to 64, found \"0\""},
        {{"/joints", 3}, "m.json: input.scale: expected 9 numbers, found 6"},
        {{"/joints", 2.5}, "m.json: joints: expected a whole number from 1 to 64, found \"2.5\""},
        {{"/joints", 18446744073709551615ULL},
         "m.json: joints: expected a whole number from 1 to 64, found \"18446744073709551615\""},
        {{"/joints", "two"}, "m.json: joints: expected a whole number from 1 to 64, found \"two\""},
        {{"/sample_period_s", -1}, "m.json: sample_period_s: expected a number from 1e-06 to 10, found -1"},
        {{"/sample_period_s", 1e30},
         "m.json: sample_period_s: expected a number from 1e-06 to 10, found 1e+30"},
        {{"/sample_period_s", 1e300},
         "m.json: sample_period_s: expected a number that single precision holds, found \"1e+300\""},
        {{"/forgetting_factor", 1.01},
         "m.json: forgetting_factor: expected a number from 0.8333333333333334 to 1, found 1.01"},
        {{"/input", 1}, "m.json: input: expected an object, found \"1\""},
        {{"/input/kind", "DFX"}, "input: expected one of STD, DF, DFW, DFR, DFSR, found \"DFX\""},
        {{"/input/lags", 1000000},
         "m.json: input.lags: expected a whole number from 0 to 1000, found \"1000000\""},
        {{"/input/rows", {1, 2}}, "m.json: input.rows: expected 15 numbers, found 2"},
        {{"/input/rows_per_joint", 6},
         "m.json: input.rows_per_joint: expected a number that fits input DFR with 4 lags, found 6"},
        {{"/input/rows/3", nullptr},
         "m.json: input.rows: expected a number that single precision holds, found \"null\""},
        {{"/features/count", 2147483647},
         "m.json: features.count: expected a whole number from 1 to 5000, found \"2147483647\""},
        {{"/features/count", 4}, "m.json: features.omega: expected 24 numbers, found 18"},
        {{"/features/orthogonal", 1}, "m.json: features.orthogonal: expected true or false, found \"1\""},
        {{"/features/length_scale", 0}, "m.json: features.length_scale: expected a positive number, found 0"},
        {{"/outputs/names", nlohmann::json::array()},
         "m.json: outputs.names: expected 1 to 64 texts, found 0"},
        {{"/outputs/noise_std/0", 0}, "m.json: outputs.noise_std: expected positive numbers, found 0"},
        {{"/outputs/noise_std/0", 1e-60},
         "m.json: outputs.noise_std: expected positive numbers, found 1e-60"},
        {{"/start/diagonal/2", -1}, "m.json: start.diagonal: expected positive numbers, found -1"},
        {{"/start/unit_upper", {1}}, "m.json: start.unit_upper: expected 15 numbers, found 1"},
        {{"/limits/innovation", 0}, "m.json: limits.innovation: expected a positive number, found 0"},
        {{"/training/seed", -1},
         "m.json: training.seed: expected a whole number that is not negative, found \"-1\""},
    };
    for (const auto& [change, message] : cases) {
        CAPTURE(change.first);
        CHECK(refusal_with(change.first, change.second) == message);
    }
}

TEST_CASE("a model that lacks a field is rejected with the name of the field") {
    std::mt19937_64 engine(1);
    const nlohmann::json good = nlohmann::json::parse(model_to_json(small_model(engine, InputKind::DFSR)));
    for (const auto& [name, value] : good.items()) {
        nlohmann::json json = good;
        json.erase(name);
        CHECK(refusal(json.dump()) == "m.json: " + name + ": expected this field, found none");
    }
}

TEST_CASE("files that are not JSON objects are rejected") {
    CHECK(refusal("[1]") == "m.json: expected a JSON object, found an array");
    CHECK(refusal("\x89PNG") == "m.json: byte 1: expected JSON, found something else or the end of the file");
    CHECK(refusal("{\"schema\": 1e999}") ==
          "m.json: expected numbers that a double holds, found a larger one");
    CHECK(refusal(std::string(100000, '[')).has_value());
}

TEST_CASE("a model file that cannot be read is reported with the reason") {
    const dfdyn::tests::TemporaryDirectory directory;
    const std::string missing = directory.path() / "none.json";
    CHECK_THROWS_WITH(read_model(missing),
                      Catch::Matchers::StartsWith(missing + ": cannot be read as a model: No such"));
    CHECK_THROWS_AS(read_model(directory.path()), InputError);
    CHECK_THROWS_AS(read_model(directory.write("empty.json", "")), InputError);
}
