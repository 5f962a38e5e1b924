// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/target.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/sizing/sized_model.hpp"
#include "tests/tools/support/project.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/error.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>
#include <sstream>
#include <string>

namespace target_test {

using namespace dfdyn::tools;

/// The model of `tests/cortex_m/images/benchmark.cpp`: NP, DFR(10, 3), six outputs, forgetting.
TrainedModel benchmark_model(int joints, int columns) {
    TrainedModel model = dfdyn::tests::sized_model(joints, 6, 10, 3, columns / 2);
    model.forgetting_factor = 0.9995;
    return model;
}

std::int64_t number(std::string text) {
    std::erase(text, ',');
    return std::stoll(text);
}

TEST_CASE("the predicted instructions are at least those counted on each core, and at most 14 % more") {
    const std::string page = read_file(dfdyn::tests::project / "docs/reference/performance.md");
    const std::regex row(R"(\| (cortex-[a-z0-9-]+) \| float \| (\d) \| (\d+) \| ([\d,]+) \| ([\d,]+) \|)");
    int rows = 0;
    for (std::sregex_iterator at(page.begin(), page.end(), row), end; at != end; ++at) {
        const std::smatch& cells = *at;
        CAPTURE(cells[0].str());
        const TickInstructions predicted =
            instructions_of(benchmark_model(std::stoi(cells[2]), std::stoi(cells[3])), find_target(cells[1]));
        CHECK(predicted.predict >= number(cells[4]));
        CHECK(predicted.predict_and_learn >= number(cells[5]));
        CHECK(static_cast<double>(predicted.predict) <= 1.14 * static_cast<double>(number(cells[4])));
        CHECK(static_cast<double>(predicted.predict_and_learn) <=
              1.14 * static_cast<double>(number(cells[5])));
        ++rows;
    }
    CHECK(rows == 24);
}

TEST_CASE("an unknown core is rejected with the nearest known one") {
    CHECK_THROWS_MATCHES(find_target("cortex-m8"), InputError,
                         Catch::Matchers::Message("--target: expected one of cortex-m7, cortex-m7-double, "
                                                  "cortex-m4f, cortex-m55, found \"cortex-m8\" (did you mean "
                                                  "\"cortex-m7\"?)"));
}

TEST_CASE("the printed bytes of a footprint are bounds: none is rounded down") {
    const std::regex sizes("flash at most ([0-9.]+) KiB, RAM at most ([0-9.]+) KiB");
    for (int columns = 20; columns <= 100; columns += 20) {
        const TrainedModel model = benchmark_model(4, columns);
        const ModelNeeds needs = needs_of(model);
        std::ostringstream out;
        print_footprint(out, model, targets().front());
        const std::string text = out.str();
        CAPTURE(text, needs.flash_bytes, needs.ram_bytes);
        std::smatch found;
        REQUIRE(std::regex_search(text, found, sizes));
        CHECK(1024 * std::stod(found[1]) >= static_cast<double>(needs.flash_bytes));
        CHECK(1024 * std::stod(found[2]) >= static_cast<double>(needs.ram_bytes));
        CHECK(1024 * (std::stod(found[1]) - 0.101) < static_cast<double>(needs.flash_bytes));
    }
}

TEST_CASE("smaller models are listed with their larger error, in text and in JSON") {
    TrainedModel model = benchmark_model(4, 100);
    std::ostringstream alone;
    print_footprint(alone, model, targets().front());
    CHECK(std::ranges::count(alone.str(), '\n') == 1);

    model.training.sizes = {
        {25, 20480, 8192, 1000, 0.44}, {50, 40960, 16384, 2000, 0.4}, {100, 1, 1, 1, 0.3}};
    std::ostringstream out;
    print_footprint(out, model, targets().front());
    CHECK_THAT(out.str(), Catch::Matchers::EndsWith(
                              "this model: 0.400):\n"
                              "  25 features: flash 20.0 KiB, RAM 8.0 KiB, nRMSE 0.440 (+10.0 %)\n"));

    const auto json = footprint_json(model, targets().front());
    const ModelNeeds needs = needs_of(model);
    CHECK(json.at("flash_bytes") == needs.flash_bytes);
    CHECK(json.at("ram_bytes") == needs.ram_bytes);
    CHECK(json.at("instructions").at("predict_and_learn") ==
          instructions_of(model, targets().front()).predict_and_learn);
    CHECK(json.at("held_out_nrmse") == 0.4);
    REQUIRE(json.at("smaller").size() == 1);
    CHECK(json.at("smaller").at(0).at("features") == 25);
}

} // namespace target_test
