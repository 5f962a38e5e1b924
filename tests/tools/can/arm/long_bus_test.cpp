// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/replay_bus.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/slow_build.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/can/arm/bus_sampler.hpp"
#include "tools/can/log/bus_traffic.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/replay/replay_can.hpp"
#include "tools/replay/replay_csv.hpp"

#include <chrono>
#include <deque>
#include <fstream>

#include <unistd.h>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;

const std::string bus_of_eight = R"({
  "schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 1000,
  "joints": {"family": "icub_two_joint_board", "boards": [
    {"address": 1, "joints": [1, 2], "ticks_per_degree": [182, 182]},
    {"address": 2, "joints": [3, 4], "ticks_per_degree": [182, 182]},
    {"address": 3, "joints": [5, 6], "ticks_per_degree": [182, 182]},
    {"address": 4, "joints": [7, 8], "ticks_per_degree": [182, 182]}]},
  "output": {"family": "icub_strain", "address": 13, "full_scale": [1500, 1500, 2000, 35, 35, 25]},
  "trigger": )";
const std::string set = R"({"on": "set"})";

double position_at(double time_s, std::size_t joint) {
    return 1.2 * std::sin((0.4 + 0.13 * static_cast<double>(joint)) * time_s + 0.1);
}

/// Frames of an arm in motion, generated on demand, because an hour of them would exceed the memory.
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
                position_[i] = position_at(t, i);
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

/// Statistics of the samples from the bus.
struct Outcome {
    std::int64_t samples = 0;
    std::int64_t valid = 0;   ///< samples with an output
    std::int64_t lost = 0;    ///< samples without positions, after the first valid one
    std::int64_t not_new = 0; ///< samples with positions but without an output, after the first valid one
    std::int64_t out_of_order = 0; ///< intervals shorter than the two frames of a wrench, or impossibly long
    std::int64_t untrue = 0;
    std::int64_t learned = 0;
    std::int64_t unlearned = 0; ///< outputs with a full lag window that were not learned
    std::int64_t pages_grown = 0;
    double took_s = 0;
};

/// Counts the samples from a bus.
class Listener {
  public:
    explicit Listener(const TrainedModel& model)
        : estimator_(make_estimator(model, true)), lags_(model.input.lags), gap_ns_(gap_ns(model)) {}

    void take(const BusSample& sample) {
        ++outcome.samples;
        if (!sample.valid()) {
            outcome.lost += outcome.valid > 0 ? 1 : 0;
            return;
        }
        follow_time(sample.sample.time_ns);
        const bool output = sample.sample.output_valid;
        outcome.valid += output ? 1 : 0;
        outcome.not_new += !output && outcome.valid > 0 ? 1 : 0;
        outcome.untrue += is_true(sample) ? 0 : 1;
        const bool learned =
            estimator_->tick({sample.sample.time_ns, sample.positions(), {}, {}, sample.valid_outputs()})
                .status.learned();
        outcome.learned += learned ? 1 : 0;
        outcome.unlearned += output && window_ >= lags_ && !learned ? 1 : 0;
        pages_ = outcome.valid == 1'000 ? resident_pages() : pages_;
    }

    void finish() { outcome.pages_grown = resident_pages() - pages_; }

    Outcome outcome;

  private:
    void follow_time(std::int64_t time_ns) {
        const std::int64_t step_ns = time_ns - last_ns_;
        const bool first = outcome.valid == 0;
        outcome.out_of_order += !first && (step_ns < 230'000 || step_ns > 1'770'000) ? 1 : 0;
        window_ = step_ns > gap_ns_ ? 0 : window_ + 1;
        last_ns_ = time_ns;
    }

    /// Compares a sample with the true motion at its time. Tolerance: 0.8 ms of waiting and the sensors'
    /// steps.
    static bool is_true(const BusSample& sample) {
        const double t = 1e-9 * static_cast<double>(sample.sample.time_ns - BusTraffic::lead_ns);
        bool good = true;
        for (std::size_t i = 0; i < sample.positions().size(); ++i) {
            good = good && std::abs(sample.positions()[i] - position_at(t, i)) < 1e-2;
        }
        for (std::size_t k = 0; k < sample.valid_outputs().size(); ++k) {
            good = good && std::abs(sample.valid_outputs()[k] - 8 * position_at(t, k)) < 0.1 + 0.1;
        }
        return good;
    }

    std::unique_ptr<RuntimeEstimator> estimator_;
    int lags_;
    std::int64_t gap_ns_;
    std::int64_t last_ns_ = 0;
    int window_ = 0;
    std::int64_t pages_ = 0;
};

Outcome listen_to(std::int64_t rows, const std::string& trigger) {
    const TemporaryDirectory directory;
    const BusDescription description =
        read_bus_description(directory.write("bus.json", bus_of_eight + trigger + "}"));
    std::mt19937_64 engine(1);
    Listener listener(
        dfdyn::tests::unlearned_model(engine, 8, 1e-3, output_names(OutputKind::wrench, 8), 100));
    BusSampler sampler(description, [&](const BusSample& sample) { listener.take(sample); });
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
    listener.finish();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    listener.outcome.took_s = took.count();
    return listener.outcome;
}

/// Writes the rows of a live replay, and records the memory long after the first tick was dropped.
class WatchedRows final : public TickSink {
  public:
    WatchedRows(const std::filesystem::path& path, const TrainedModel& model, std::int64_t full_after)
        : file_(path, model), full_after_(full_after) {}

    void take(const ReplayedRecording& replayed, std::size_t tick) override {
        file_.take(replayed, tick);
        ++rows;
        pages_ = rows == full_after_ ? resident_pages() : pages_;
    }
    void flush() override { file_.flush(); }
    std::int64_t pages_grown() const { return resident_pages() - pages_; }

    std::int64_t rows = 0;

  private:
    ReplayCsvFile file_;
    std::int64_t full_after_;
    std::int64_t pages_ = 0;
};

/// Replays the arm as `replay --can` does, keeping `kept` ticks. Checks that each tick is written and that
/// the memory is constant.
void check_live_replay(std::int64_t rows, std::size_t kept, const std::filesystem::path& csv) {
    const TemporaryDirectory directory;
    const BusDescription description =
        read_bus_description(directory.write("bus.json", bus_of_eight + set + "}"));
    std::mt19937_64 engine(1);
    const TrainedModel model =
        dfdyn::tests::unlearned_model(engine, 8, 1e-3, output_names(OutputKind::wrench, 8), 10);
    const auto estimator = make_estimator(model, true);
    WatchedRows sink(csv, model, 3 * static_cast<std::int64_t>(kept));
    CanReplayer replayer(*estimator, {&model, 1}, description, "bus", 0, {kept, &sink});
    ArmInMotion arm(description, rows);
    dfdyn::hal::ReplayBus bus(arm);
    std::array<dfdyn::hal::Frame, 1> one;
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        for (const dfdyn::hal::Frame& frame : bus.drain(one)) {
            replayer.sampler().take(frame, bus.state(), bus.counters());
        }
    }
    const std::int64_t grown = sink.pages_grown();
    const ReplayedRecording replayed = replayer.finish(bus.counters()).replayed;
    CHECK(sink.rows >= rows - 1);
    CHECK(static_cast<std::int64_t>(replayed.forgotten + replayed.time_s.size()) == sink.rows);
    CHECK(replayed.time_s.size() < 2 * kept);
    if (!dfdyn::tests::slow_build) {
        CHECK(grown < 64); // 0.25 MiB
    }
}

void check(const Outcome& outcome, std::int64_t rows) {
    CHECK(outcome.valid <= rows - 9); // a source qualifies after ten readings
    CHECK(outcome.valid >= rows - 12);
    CHECK(outcome.lost == 0);
    CHECK(outcome.not_new == 0);
    CHECK(outcome.out_of_order == 0);
    CHECK(outcome.untrue == 0);
    CHECK(outcome.unlearned == 0);
    if (!dfdyn::tests::slow_build) {      // slow builds record every allocated block
        CHECK(outcome.pages_grown < 256); // 1 MiB
    }
}

} // namespace

TEST_CASE(
    "eight joints and a wrench at 1 kHz on a bus at 80 % load: every sample is unique, correct and learned") {
    check(listen_to(20'000, set), 20'000);
}

TEST_CASE("on a loaded bus a timer's samples are regular and most wrenches are learned") {
    const Outcome outcome = listen_to(20'000, R"({"on": "timer"})");
    CHECK(outcome.lost == 0);
    CHECK(outcome.untrue == 0);
    CHECK(outcome.unlearned == 0);
    CHECK(outcome.learned > 16'000); // two wrenches between two ticks count as one
    CHECK(outcome.valid + outcome.not_new >= 19'980);
}

TEST_CASE("a live replay writes each tick in constant memory after the first ticks are dropped") {
    const TemporaryDirectory directory;
    const auto csv = directory.path() / "out.csv";
    check_live_replay(12'000, 1'000, csv);
    const std::string text = dfdyn::tests::file_content(csv);
    CHECK(std::ranges::count(text, '\n') >= 12'000);
}

TEST_CASE("a live replay of an hour at 1 kHz uses no more memory than its first minutes", "[.long]") {
    check_live_replay(3'600'000, 32'768, "/dev/null");
}

TEST_CASE("an hour of eight joints and a wrench at 1 kHz at 80 % load: samples are unique, correct and "
          "learned in constant memory",
          "[.long]") {
    constexpr std::int64_t rows = 3'600'000;
    const Outcome outcome = listen_to(rows, set);
    check(outcome, rows);
    WARN("3600 s in " << outcome.took_s << " s, " << 3600 / outcome.took_s << " times real time; learned "
                      << outcome.learned << " of " << outcome.valid);
}
