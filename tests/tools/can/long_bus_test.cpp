// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/replay_bus.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/can/bus_sampler.hpp"
#include "tools/can/bus_traffic.hpp"
#include "tools/host/host_estimator.hpp"

#include <chrono>
#include <deque>
#include <fstream>

#include <unistd.h>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;

constexpr const char* bus_of_eight = R"({
  "schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 1000, "trigger": {"on": "set"},
  "joints": {"family": "icub_two_joint_board", "boards": [
    {"address": 1, "joints": [1, 2], "ticks_per_degree": [182, 182]},
    {"address": 2, "joints": [3, 4], "ticks_per_degree": [182, 182]},
    {"address": 3, "joints": [5, 6], "ticks_per_degree": [182, 182]},
    {"address": 4, "joints": [7, 8], "ticks_per_degree": [182, 182]}]},
  "output": {"family": "icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25]}
})";

/// The frames of an arm in motion, made as they are asked for: an hour of them would fill the memory.
class ArmInMotion {
  public:
    ArmInMotion(const BusDescription& description, std::int64_t rows)
        : traffic_(description, {50, 1}, [this](const dfdyn::hal::Frame& frame) { ready_.push_back(frame); }),
          rows_(rows) {}

    bool next(dfdyn::hal::ReplayEntry& entry) noexcept {
        entry = {};
        while (ready_.empty() && row_ <= rows_) {
            add_row();
        }
        if (ready_.empty()) {
            return false;
        }
        entry.frame = ready_.front();
        ready_.pop_front();
        return true;
    }

  private:
    void add_row() {
        if (row_ == rows_) {
            traffic_.finish();
        } else {
            const double t = 1e-3 * static_cast<double>(row_);
            for (std::size_t i = 0; i < position_.size(); ++i) {
                position_[i] = 1.2 * std::sin((0.4 + 0.13 * static_cast<double>(i)) * t + 0.1);
            }
            for (std::size_t k = 0; k < wrench_.size(); ++k) {
                wrench_[k] = 8 * position_[k] + 0.1 * std::sin(977 * t + static_cast<double>(k));
            }
            traffic_.add(1'000'000 * row_, position_, wrench_);
        }
        ++row_;
    }

    std::deque<dfdyn::hal::Frame> ready_;
    BusTraffic traffic_;
    std::int64_t rows_;
    std::int64_t row_ = 0;
    std::array<double, 8> position_{};
    std::array<double, 6> wrench_{};
};

std::int64_t resident_pages() {
    std::ifstream file("/proc/self/statm");
    std::int64_t total = 0;
    std::int64_t resident = 0;
    file >> total >> resident;
    return resident;
}

} // namespace

TEST_CASE("an hour of eight joints and a wrench at 1 kHz: every sample once, learned, in flat memory",
          "[.long]") {
    constexpr std::int64_t rows = 3'600'000;
    const TemporaryDirectory directory;
    const BusDescription description = read_bus_description(directory.write("bus.json", bus_of_eight));
    std::mt19937_64 engine(1);
    const TrainedModel model =
        dfdyn::tests::unlearned_model(engine, 8, 1e-3, output_names(OutputKind::wrench, 8), 100);
    const auto estimator = make_estimator(model, true);
    std::int64_t samples = 0;
    std::int64_t valid = 0;
    std::int64_t learned = 0;
    std::int64_t out_of_step = 0;
    std::int64_t last_ns = 0;
    std::int64_t pages = 0;
    BusSampler sampler(description, [&](const BusSample& sample) {
        ++samples;
        if (!sample.output_valid()) {
            return;
        }
        ++valid;
        out_of_step += valid > 1 && std::abs(sample.time_ns - last_ns - 1'000'000) > 300'000 ? 1 : 0;
        last_ns = sample.time_ns;
        learned += estimator->tick({sample.time_ns, sample.position, {}, {}, sample.output}).status.learned();
        pages = valid == 10'000 ? resident_pages() : pages;
    });
    ArmInMotion arm(description, rows);
    dfdyn::hal::ReplayBus bus(arm);
    std::array<dfdyn::hal::Frame, 1> one;
    const auto begin = std::chrono::steady_clock::now();
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        for (const dfdyn::hal::Frame& frame : bus.drain(one)) {
            sampler.take(frame, bus.state(), bus.counters());
        }
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    CHECK(samples >= rows - 2);
    CHECK(samples <= rows);
    CHECK(valid == rows - 9); // a source must show ten readings
    CHECK(out_of_step == 0);
    CHECK(learned == valid - model.input.lags);
    CHECK(resident_pages() - pages < 256); // 1 MiB
    WARN("3600 s in " << took.count() << " s, " << 3600 / took.count() << " times real time");
}
