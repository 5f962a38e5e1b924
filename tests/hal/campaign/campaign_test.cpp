// SPDX-License-Identifier: Apache-2.0
// Random mixtures of every fault of the legend, for every family and trigger: no accepted value is wrong.
#include "tests/hal/campaign/campaign.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

namespace {

using namespace dfdyn::tests;

const char* name_of(Trigger trigger) {
    return trigger == Trigger::timer ? "timer" : trigger == Trigger::set ? "set" : "sync";
}

void print_header() {
    std::cout << "seed " << seed()
              << "\n| family and output | trigger | frames | faults | accepted | outputs | wrong | "
              << "refused although good |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
}
double share(std::uint64_t part, std::uint64_t of) {
    return static_cast<double>(part) / std::max(1.0, static_cast<double>(of));
}
void print(const CampaignRow& row) {
    std::cout << "| " << row.family << " | " << name_of(row.trigger) << " | " << row.frames << " | "
              << row.faults << " | " << row.accepted << " | " << row.outputs << " | "
              << row.wrong_positions + row.wrong_outputs << " | " << std::fixed << std::setprecision(2)
              << 100 * share(row.refused_good, row.good) << " % |\n";
}

/// Adds the row of one family and trigger to the sum.
template <class Arm>
void fight(Trigger trigger, std::uint64_t frames, std::mt19937_64& engine, CampaignRow& sum) {
    const CampaignRow row = Campaign<Arm>(trigger, engine).run(frames, campaign_faults());
    print(row);
    CAPTURE(row.family, name_of(row.trigger), row.wrong_by_fault);
    CHECK(row.wrong_positions == 0);
    CHECK(row.wrong_outputs == 0);
    CHECK(row.accepted > row.frames / 10); // it is not right by saying nothing
    sum.good += row.good;
    sum.refused_good += row.refused_good;
    sum.unlearned_good += row.unlearned_good;
}

void fight_all(std::uint64_t frames, double most_refused) {
    DFDYN_SEEDED_ENGINE(engine);
    print_header();
    constexpr std::uint64_t rows = 14;
    CampaignRow sum;
    for (const Trigger trigger : {Trigger::timer, Trigger::set}) {
        fight<IcubArm>(trigger, frames / rows, engine, sum);
        fight<FocArm>(trigger, frames / rows, engine, sum);
        fight<FocWrenchArm>(trigger, frames / rows, engine, sum);
        fight<FreeDriveArm>(trigger, frames / rows, engine, sum);
        fight<OdriveArm>(trigger, frames / rows, engine, sum);
    }
    for (const Trigger trigger : {Trigger::timer, Trigger::sync}) {
        fight<DriveArm>(trigger, frames / rows, engine, sum);
        fight<WrappingArm>(trigger, frames / rows, engine, sum);
    }
    CHECK(share(sum.refused_good, sum.good) < most_refused);
    CHECK(share(sum.unlearned_good, sum.good) < 0.01);
}

} // namespace

TEST_CASE("no mixture of faults makes a wrong position, effort or wrench valid") { fight_all(200'000, 0.02); }

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

TEST_CASE("no mixture of faults in five million frames makes a wrong value valid", "[.long]") {
    fight_all(5'000'000, 0.01);
}
