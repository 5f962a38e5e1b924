// SPDX-License-Identifier: Apache-2.0
// Random mixtures of every fault of the legend, for every family and trigger: number of accepted wrong
// values.
#include "tests/hal/campaign/campaign_table.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace {

using namespace dfdyn::tests;

using dfdyn::hal::Encoder;

void fight_all(const Encoders& encoders, std::uint64_t frames, double most_wrong, double most_refused,
               double most_undecidable) {
    DFDYN_SEEDED_ENGINE(engine);
    print_header();
    const std::vector<CampaignArm> arms = campaign_arms();
    CampaignRow sum;
    for (const CampaignArm& arm : arms) {
        for (const Trigger trigger : {Trigger::timer, arm.synchronous ? Trigger::sync : Trigger::set}) {
            fight(arm, trigger, encoders, frames / (2 * arms.size()), engine, sum);
        }
    }
    check_sum(sum, most_wrong, most_refused, most_undecidable);
}

using dfdyn::hal::Frame;

std::vector<Frame> sent_by(const CampaignArm& arm) {
    std::vector<Frame> sent;
    const auto add = [&](const wire::Frames& frames) {
        std::copy_n(frames.frame.begin(), frames.count, std::back_inserter(sent));
    };
    for (std::size_t board = 0; board < arm.boards; ++board) {
        add(arm.frames(board, {}));
    }
    if (arm.wrench) {
        add(arm.wrench({}));
    }
    return sent;
}

/// Returns a frame with every other length and other flags that a bus can carry.
std::vector<Frame> other_forms(const Frame& sound) {
    std::vector<Frame> others;
    for (unsigned flags = 0; flags < 8; ++flags) {
        for (std::uint8_t length = 0; length <= 64; ++length) {
            Frame frame = sound;
            frame.remote = sound.remote != ((flags & 1U) != 0);
            frame.fd = sound.fd != ((flags & 2U) != 0);
            frame.extended = sound.extended != ((flags & 4U) != 0);
            frame.id &= frame.extended ? 0x1FFFFFFFU : 0x7FFU;
            frame.bit_rate_switch = frame.bit_rate_switch && frame.fd;
            frame.length = length;
            std::fill(frame.data.begin() + length, frame.data.end(), std::uint8_t{0});
            if (dfdyn::hal::is_well_formed(frame)) {
                others.push_back(frame);
            }
        }
    }
    return others;
}

/// Returns true for other frame formats that devices of a family also send.
bool is_documented(const CampaignArm& arm, const Frame& sound, const Frame& frame) {
    const auto begins = [&](const char* family) { return arm.name.starts_with(family); };
    const bool other_length = frame.length != sound.length;
    const bool other_id = frame.extended != sound.extended;
    if (frame.remote) {
        return false;
    }
    if (begins(
            "moteus")) { // sub-frames that name their registers, with source and target in either identifier
        return frame.fd && frame.length > sound.length - 4;
    }
    if (begins("cubemars_mit")) { // without temperature and error
        return !other_id && (!other_length || frame.length == 6);
    }
    if (begins("damiao") || begins("robstride_mit")) { // the codec of MIT mode also takes CAN FD
        return !other_id && !other_length;
    }
    const bool strain = (sound.id & 0x7C0U) == 0x3C0U && arm.name.ends_with("icub_strain");
    return strain && !frame.fd && !other_id && frame.length == 7; // with the saturation flags
}

} // namespace

TEST_CASE("random mixtures of all faults: no accepted value is wrong") {
    fight_all({}, 200'000, 0, 0.08, 0.02); // one run of an undecidable position is 1 % of all
}

TEST_CASE("faults of described absolute encoders, mixed at random: no accepted value is wrong") {
    fight_all({Encoder::absolute, Encoder::absolute}, 200'000, 0, 0.03, 0.02);
}

TEST_CASE("no values are taken from frames of another format") {
    for (const CampaignArm& arm : campaign_arms()) {
        for (const Frame& sound : sent_by(arm)) {
            CHECK(arm.has_form(sound));
            for (const Frame& frame : other_forms(sound)) {
                CAPTURE(arm.name, sound.id, int{sound.length}, frame.extended, frame.fd, frame.remote,
                        int{frame.length});
                CHECK((arm.has_form(frame) || is_documented(arm, sound, frame) || !arm.has_values(frame)));
            }
        }
    }
}

TEST_CASE("docs/reference/faults.md and the campaign list the same faults") {
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

// The seeds' results are in docs/reference/faults.md.
TEST_CASE("all faults mixed over five million frames, encoders not described: 2e-3 of the accepted values "
          "wrong, 2 % of good ones rejected at most",
          "[.long]") {
    fight_all({}, 5'000'000, 2e-3, 0.02, 0.01);
}

TEST_CASE("five million frames of absolute encoders that are not described: 1e-4 of the accepted values "
          "wrong, 2 % of good ones rejected at most",
          "[.long]") {
    fight_all({Encoder::unknown, Encoder::absolute}, 5'000'000, 1e-4, 0.02, 0.01);
}

TEST_CASE("five million frames of described absolute encoders: 1e-4 of the accepted values wrong, 1 % of "
          "good ones rejected at most",
          "[.long]") {
    fight_all({Encoder::absolute, Encoder::absolute}, 5'000'000, 1e-4, 0.01, 0.01);
}

TEST_CASE("five million frames of described incremental encoders: 1e-4 of the accepted values wrong, 12 % of "
          "good ones rejected at most",
          "[.long]") {
    fight_all({Encoder::incremental, Encoder::incremental}, 5'000'000, 1e-4, 0.12, 0.01);
}
