// SPDX-License-Identifier: Apache-2.0
// Random mixtures of every fault of the legend, for every family and trigger: how many accepted values are
// wrong.
#include "tests/hal/campaign/campaign_table.hpp"

#include <fstream>
#include <sstream>

namespace {

using namespace dfdyn::tests;

void fight_all(std::uint64_t frames, double most_wrong, double most_refused) {
    DFDYN_SEEDED_ENGINE(engine);
    print_header();
    const std::vector<CampaignArm> arms = campaign_arms();
    CampaignRow sum;
    for (const CampaignArm& arm : arms) {
        for (const Trigger trigger : {Trigger::timer, arm.synchronous ? Trigger::sync : Trigger::set}) {
            fight(arm, trigger, frames / (2 * arms.size()), engine, sum);
        }
    }
    check_sum(sum, most_wrong, most_refused);
}

} // namespace

TEST_CASE("all faults mixed at random make no accepted value wrong") { fight_all(200'000, 0, 0.08); }

TEST_CASE("the legend and the campaign have the same faults") {
    std::ifstream legend(DFDYN_TEST_DATA_DIR "/../../docs/reference/faults.md");
    REQUIRE(legend);
    std::size_t found = 0;
    for (std::string line; std::getline(legend, line) && line != "## Tested one by one";) {
        std::istringstream cells(line);
        std::string before, number, name;
        std::getline(std::getline(std::getline(cells, before, '|'), number, '|'), name, '|');
        if (number.find_first_not_of(" 0123456789") != std::string::npos ||
            number.find_first_of("0123456789") == std::string::npos) {
            continue;
        }
        CAPTURE(line);
        REQUIRE(found < campaign_faults().size());
        CHECK(std::stoi(number) == campaign_faults()[found].number);
        CHECK(name == ' ' + std::string(campaign_faults()[found].name) + ' ');
        ++found;
    }
    CHECK(found == campaign_faults().size());
}

// docs/reference/faults.md has the figures of eight seeds: none to three of 1.4 million are wrong.
TEST_CASE("all faults mixed over five million frames make at most one of a hundred thousand accepted values "
          "wrong",
          "[.long]") {
    fight_all(5'000'000, 1e-5, 0.02);
}
