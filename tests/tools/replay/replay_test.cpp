// SPDX-License-Identifier: Apache-2.0
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/error.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_csv.hpp"
#include "tools/replay/replay_report.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace replay_test {

using namespace dfdyn::tools;
using dfdyn::tests::small_model;

/// `rows` samples, 4 ms apart, of two moving joints and six outputs that follow them.
Recording moving_arm(std::size_t rows) {
    Recording recording;
    recording.source = "run.csv";
    recording.position.names = joint_names("q", 2);
    recording.output.names = output_names(OutputKind::wrench, 2);
    for (std::size_t row = 0; row < rows; ++row) {
        const double t = 0.004 * static_cast<double>(row);
        recording.time_s.push_back(t);
        recording.time_ns.push_back(4000000 * static_cast<std::int64_t>(row));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        recording.position.values.insert(recording.position.values.end(), {std::sin(3 * t), std::cos(5 * t)});
        for (int k = 0; k < 6; ++k) {
            recording.output.values.push_back(std::sin(3 * t) * k + std::cos(5 * t));
        }
    }
    return recording;
}

ReplayedRecording replay_of(const TrainedModel& model, const Recording& recording, std::size_t horizon) {
    const auto estimator = make_estimator(model, true);
    return replay(*estimator, {&model, 1}, recording, horizon, [](std::size_t) {});
}

ReplayedRecording with_innovations(const std::vector<float>& innovations) {
    ReplayedRecording replayed;
    for (std::size_t tick = 0; tick < innovations.size(); ++tick) {
        replayed.time_s.push_back(0.1 * static_cast<double>(tick));
    }
    replayed.normalised_innovation_squared = innovations;
    return replayed;
}

TEST_CASE("a replay predicts once the window is full and again after a gap and learns") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    Recording recording = moving_arm(200);
    recording.gap_before[100] = 1;
    const ReplayedRecording replayed = replay_of(model, recording, 3);
    REQUIRE(replayed.status.size() == 200);
    for (std::size_t tick = 0; tick < 200; ++tick) {
        const bool filling = tick % 100 < 4;
        CHECK(replayed.status[tick].predicted() == !filling);
        CHECK(std::isnan(replayed.predicted[6 * tick]) == filling);
        CHECK(replayed.status[tick].learned() == !filling);
    }
    CHECK(replayed.horizon.size() == 2 * (96 - 3));
}

TEST_CASE("no horizon of a model with measured derivatives extends across a gap") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = dfdyn::tests::small_physics_model(engine, "P", InputKind::STD, true);
    Recording recording = moving_arm(20);
    recording.velocity = recording.acceleration = recording.position;
    recording.gap_before[10] = 1;
    const ReplayedRecording replayed = replay_of(model, recording, 3);
    REQUIRE(replayed.totals.predicted == 20); // there is no window that fills
    CHECK(replayed.horizon.size() == 2 * (10 - 3));
}

TEST_CASE("predictions at the model's bound count as predictions, so that fewer are never learned") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    model.limits.prediction.assign(6, 1e-3);
    const ReplayedRecording replayed = replay_of(model, moving_arm(200), 0);
    CHECK(std::ranges::count(replayed.status, dfdyn::Reason::prediction_bounded, &dfdyn::Status::prediction) >
          100);
    CHECK(replayed.totals.predicted == 196);
    CHECK(replayed.totals.learned == 196);
}

TEST_CASE("the cost of a tick is that of what the replay did") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const auto estimator = make_estimator(model, true);
    const dfdyn::Cost cost = estimator->cost();
    const auto operations = [&](std::size_t rows) {
        const ReplayedRecording replayed = replay_of(model, moving_arm(rows), 0);
        return summarise({&model, 1}, *estimator, {&replayed, 1}, 0).operations;
    };
    CHECK(operations(50) == cost.predict + cost.learn);
    CHECK(operations(3) == cost.predict + cost.variance); // nothing is learned while the window fills
}

TEST_CASE("the report of a replay without any prediction claims no agreement with the model") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const auto estimator = make_estimator(model, true);
    const auto summary_of = [&](std::size_t rows) {
        const std::vector<ReplayedRecording> replayed{replay_of(model, moving_arm(rows), 0)};
        const ReplaySummary summary = summarise({&model, 1}, *estimator, replayed, 0);
        return make_replay_report(model, replayed, summary).summary;
    };
    CHECK(summary_of(3) == "3 ticks, nothing was predicted.");
    CHECK_THAT(summary_of(50), Catch::Matchers::ContainsSubstring("The measurement "));
}

TEST_CASE("the report of a recording without ticks has neither curves nor times") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const auto estimator = make_estimator(model, true);
    const std::vector<ReplayedRecording> replayed{replay_of(model, moving_arm(0), 0),
                                                  replay_of(model, moving_arm(50), 0)};
    const ReplaySummary summary = summarise({&model, 1}, *estimator, replayed, 0);
    const Report report = make_replay_report(model, replayed, summary);
    CHECK(report.recordings.size() == 1);
    CHECK(report.time_s.size() == 50);
    const ReplaySummary nothing = summarise({&model, 1}, *estimator, {replayed.data(), 1}, 0);
    CHECK(make_replay_report(model, {replayed.data(), 1}, nothing).time_s.empty());
    CHECK(replay_json(nothing)["tick_us"]["median"].dump() == "null");
}

TEST_CASE("a recording that does not fit the model is rejected") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DF);
    Recording other = moving_arm(10);
    other.output.names = output_names(OutputKind::joint_torque, 6);
    CHECK_THROWS_WITH(replay_of(model, other, 0), "run.csv: expected the model's outputs fx, fy, fz, mx, my, "
                                                  "mz, found tau1, tau2, tau3, tau4, tau5, tau6");
    other.position.names = joint_names("q", 3);
    CHECK_THROWS_WITH(replay_of(model, other, 0),
                      "run.csv: expected positions of 2 joints as the model has, found 3");
}

TEST_CASE("an endless replay keeps its last ticks and passes on all ticks without further memory") {
    class Counter final : public TickSink {
      public:
        void take(const ReplayedRecording& replayed, std::size_t tick) override {
            in_order_ = in_order_ && replayed.time_s.at(tick) > last_s_ && replayed.bus_reason.size() > tick;
            last_s_ = replayed.time_s[tick];
            ++count_;
        }
        void flush() override {}

        std::size_t count_ = 0;
        double last_s_ = -1;
        bool in_order_ = true;
    };
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const Recording recording = moving_arm(2'000);
    const auto estimator = make_estimator(model, true);
    Counter counter;
    Replayer replayer(*estimator, "can0", 6, 0, {100, &counter});
    std::uint64_t allocations = 0; // the estimator's own allocations, which it releases in the same tick
    std::uint64_t releases = 0;
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const dfdyn::tests::AllocationGuard guard;
        if (row % 10 == 3) {
            replayer.skip(recording.time_s[row], dfdyn::hal::Reason::position_stale);
        } else {
            replayer.tick(recording.time_s[row], sample_at(recording, row), dfdyn::hal::Reason::ok);
        }
        const dfdyn::tests::HeapCalls calls = guard.calls();
        allocations += row > 20 ? calls.allocations : 0; // by then every reason has occurred
        releases += row > 20 ? calls.releases : 0;
    }
    CHECK(allocations == releases);
    CHECK(counter.count_ == 2'000);
    CHECK(counter.in_order_);
    const ReplayedRecording replayed = replayer.finish();
    CHECK(replayed.totals.ticks == 2'000);
    CHECK(replayed.totals.reasons.at("position_stale") == 200);
    CHECK(replayed.time_s.size() + replayed.forgotten == 2'000);
    CHECK(replayed.time_s.size() >= 100);
    CHECK(replayed.time_s.size() < 200);
    const std::size_t kept = replayed.time_s.size();
    CHECK(replayed.measured.size() == 6 * kept);
    CHECK(replayed.predicted.size() == 6 * kept);
    CHECK(replayed.standard_deviation.size() == 6 * kept);
    CHECK(replayed.normalised_innovation_squared.size() == kept);
    CHECK(replayed.status.size() == kept);
    CHECK(replayed.bus_reason.size() == kept);
    CHECK(replayed.duration_us.size() == kept);
    CHECK(replayed.time_s.back() == recording.time_s.back());
}

TEST_CASE("a replay of bounded length keeps the indices of its last ticks") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const Recording recording = moving_arm(300);
    const auto estimator = make_estimator(model, true);
    const auto bounded_estimator = make_estimator(model, true);
    Replayer all(*estimator, "can0", 6, 5);
    Replayer bounded(*bounded_estimator, "can0", 6, 5, {50, nullptr});
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        all.tick(recording.time_s[row], sample_at(recording, row));
        bounded.tick(recording.time_s[row], sample_at(recording, row));
    }
    const ReplayedRecording expected = all.finish();
    const ReplayedRecording found = bounded.finish();
    REQUIRE(!found.horizon.empty());
    for (const HorizonIndex& index : found.horizon) {
        REQUIRE(index.tick < found.time_s.size());
        const auto same =
            std::ranges::find(expected.horizon, index.tick + found.forgotten, &HorizonIndex::tick);
        REQUIRE(same != expected.horizon.end());
        CHECK(same->epsilon == index.epsilon);
    }
}

TEST_CASE("a replay that forgot its first ticks says so and shows no figures of its beginning") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const Recording recording = moving_arm(300);
    for (const std::size_t kept_ticks : {std::size_t{0}, std::size_t{50}}) {
        const auto estimator = make_estimator(model, true);
        Replayer replayer(*estimator, "can0", 6, 5, {kept_ticks, nullptr});
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            replayer.tick(1000 + 0.5 * static_cast<double>(row), sample_at(recording, row)); // 150 s
        }
        const std::vector<ReplayedRecording> replayed{replayer.finish()};
        const std::size_t forgotten = replayed[0].forgotten;
        REQUIRE((forgotten > 0) == (kept_ticks > 0));
        const ReplaySummary summary = summarise({&model, 1}, *estimator, replayed, 5);
        CHECK(replay_json(summary)["recordings"][0]["forgotten"] == forgotten);
        const std::string note =
            "The figures are of the last " + std::to_string(300 - forgotten) + " ticks. ";
        const Report report = make_replay_report(model, replayed, summary);
        CHECK((report.summary.find(note) != std::string::npos) == (forgotten > 0));
        CHECK(std::isnan(summary.recordings[0].horizon_transient[0]) == (forgotten > 0));
        std::vector<double> later;
        for (const HorizonIndex& index : replayed[0].horizon) {
            if (replayed[0].time_s[index.tick] >= 1030) {
                later.push_back(index.epsilon[0]);
            }
        }
        CHECK(summary.recordings[0].horizon_steady[0] == median(later));
    }
}

TEST_CASE("the normalised error follows its definition over predicted ticks only") {
    ReplayedRecording replayed;
    replayed.measured = {1, 3, 5, 7};
    replayed.predicted = {std::nanf(""), 2, 5, 9};
    // Errors 1, 0, -2 over the outputs 3, 5, 7 with mean 5: mean square 5/3, variance 8/3.
    CHECK(normalised_error(replayed, 1, 0, 0, 4) == Approx(std::sqrt(5.0 / 8.0)));
    CHECK(std::isnan(normalised_error(replayed, 1, 0, 0, 1)));
    CHECK(std::isinf(normalised_error(replayed, 1, 0, 3, 4))); // one value has no deviation
}

TEST_CASE("contradictions are intervals above the limit") {
    const float none = std::nanf("");
    const auto found =
        find_contradictions(with_innovations({none, 9, 1, 9, 8, 7, 1, 1, 1, 1, 9, 1, 1, 1, 6, 12}), 5);
    // 0.1 to 0.5 s is one and 1.4 to 1.5 s another; the single tick at 1.0 s is none.
    REQUIRE(found.size() == 2);
    CHECK(found[0].start_s == Approx(0.1));
    CHECK(found[0].end_s == Approx(0.5));
    CHECK(found[0].peak == 9);
    CHECK(found[1].start_s == Approx(1.4));
    CHECK(found[1].peak == 12);
}

TEST_CASE("the innovation limit follows the larger innovations of the two halves") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    for (double& noise : model.outputs.noise_std) {
        noise /= 10; // the innovations of the halves are large
    }
    const std::vector<Recording> recordings{moving_arm(2000)};
    calibrate_innovation_limit(model, recordings);
    CHECK(model.limits.innovation_patience == 375);
    TrainedModel unlimited = model;
    unlimited.limits.innovation = 1e30;
    double ordinary = 0;
    for (const auto& [before, half] : {std::pair{0, 1000}, std::pair{1000, 0}}) {
        const auto estimator = make_estimator(unlimited, true);
        std::vector<double> innovations;
        for (const int first : {before, half}) {
            estimator->begin_recording();
            for (int row = first; row < first + 1000; ++row) {
                const Tick tick =
                    estimator->tick(sample_at(recordings.front(), static_cast<std::size_t>(row)));
                if (first == half && tick.status.predicted()) {
                    innovations.push_back(static_cast<double>(tick.normalised_innovation_squared));
                }
            }
        }
        ordinary = std::max(ordinary, quantile(innovations, 0.999));
    }
    CHECK(model.limits.innovation == Approx(3 * ordinary));
}

TEST_CASE("the innovation limit is at least three times what noise exceeds once in a thousand samples") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = small_model(engine, InputKind::DFR);
    for (double& noise : model.outputs.noise_std) {
        noise *= 100; // the innovations of the halves are small
    }
    const std::vector<Recording> recordings{moving_arm(2000)};
    calibrate_innovation_limit(model, recordings);
    REQUIRE(model.outputs.names.size() == 6);
    CHECK(model.limits.innovation ==
          Approx(3 * 22.458).epsilon(0.02)); // chi-square with 6 degrees of freedom
}

TEST_CASE("the CSV of a replay has the columns that scripts use") {
    std::mt19937_64 engine(1);
    const TrainedModel model = small_model(engine, InputKind::DF);
    const std::vector<ReplayedRecording> replayed{replay_of(model, moving_arm(6), 0)};
    std::ostringstream text;
    write_replay_csv(text, model, replayed);
    std::istringstream lines(text.str());
    std::string line;
    std::getline(lines, line);
    CHECK(line ==
          "t,fx,fx_pred,fx_std,fy,fy_pred,fy_std,fz,fz_pred,fz_std,mx,mx_pred,mx_std,my,my_pred,my_std,"
          "mz,mz_pred,mz_std,nis,learned,status");
    std::getline(lines, line);
    CHECK_THAT(line, Catch::Matchers::StartsWith("0,1,nan,nan,"));
    CHECK_THAT(line, Catch::Matchers::EndsWith(",nan,0,window_filling"));
    std::string last;
    while (std::getline(lines, line)) {
        last = line;
    }
    CHECK_THAT(last, Catch::Matchers::EndsWith(",1,ok"));
}

} // namespace replay_test
