// SPDX-License-Identifier: Apache-2.0
// The guarantees for the recordings in this project, measured on the output of the demo.
#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/model/file/model_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

namespace {

using dfdyn::tests::TemporaryDirectory;

struct Tick {
    double t, nis;
    std::array<double, 6> measured, predicted;
};

using Ticks = std::vector<Tick>;

/// The recordings in a replay's CSV. A new one begins where t does not increase.
std::vector<Ticks> read_replay(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    std::vector<Ticks> recordings;
    while (std::getline(file, line)) {
        std::istringstream fields(line);
        std::vector<double> values;
        for (std::string field; std::getline(fields, field, ',');) {
            values.push_back(std::strtod(field.c_str(), nullptr));
        }
        Tick tick{values[0], values[19], {}, {}};
        for (std::size_t k = 0; k < 6; ++k) {
            tick.measured[k] = values[1 + 3 * k];
            tick.predicted[k] = values[2 + 3 * k];
        }
        if (recordings.empty() || tick.t <= recordings.back().back().t) {
            recordings.emplace_back();
        }
        recordings.back().push_back(tick);
    }
    return recordings;
}

/// Runs the demo and contains its results.
struct Demo {
    TemporaryDirectory directory;
    dfdyn::tools::TrainedModel model;
    std::vector<Ticks> recordings;

    explicit Demo(int seed) {
        const std::string command = std::string(DFDYN_DEMO) + " " + DFDYN_PROGRAM + " " +
                                    directory.path().string() + " --seed " + std::to_string(seed) + " > " +
                                    (directory.path() / "log").string() + " 2>&1";
        if (std::system(command.c_str()) != 0) {
            throw std::runtime_error("the demo failed: " +
                                     dfdyn::tests::file_content(directory.path() / "log"));
        }
        model = dfdyn::tools::read_model(directory.path() / "model.json");
        recordings = read_replay(directory.path() / "replay.csv");
    }

    const Ticks& slow() const { return recordings.at(0); }
    const Ticks& undisturbed() const { return recordings.at(1); }
    const Ticks& pushed() const { return recordings.at(2); }

    bool contradicts(const Tick& tick) const { return tick.nis > model.limits.innovation; }
};

double normalised_error(const Ticks& ticks, std::size_t first, std::size_t k) {
    double error = 0;
    double sum = 0;
    double square = 0;
    const auto count = static_cast<double>(ticks.size() - first);
    for (std::size_t row = first; row < ticks.size(); ++row) {
        const double y = ticks[row].measured[k];
        error += std::pow(y - ticks[row].predicted[k], 2);
        sum += y;
        square += y * y;
    }
    return std::sqrt(error / (square - sum * sum / count));
}

long longest_run_of_contradictions(const Demo& demo, const Ticks& ticks, std::size_t first) {
    long longest = 0;
    long run = 0;
    for (std::size_t row = first; row < ticks.size(); ++row) {
        run = demo.contradicts(ticks[row]) ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    return longest;
}

/// Difference of the two runs' currents at the same time, in standard deviations of the undisturbed run. It
/// is averaged over 0.1 s, and is the largest over the joints. No model is involved.
std::vector<double> difference_of_runs(const Ticks& pushed, const Ticks& undisturbed) {
    const std::size_t ticks = std::min(pushed.size(), undisturbed.size());
    std::vector<double> largest(ticks, 0);
    for (std::size_t k = 0; k < 6; ++k) {
        double sum = 0;
        double square = 0;
        for (const Tick& tick : undisturbed) {
            sum += tick.measured[k];
            square += tick.measured[k] * tick.measured[k];
        }
        const auto count = static_cast<double>(undisturbed.size());
        const double deviation = std::sqrt(square / count - sum * sum / count / count);
        for (std::size_t row = 6; row + 6 < ticks; ++row) {
            double average = 0;
            for (std::size_t near = row - 6; near <= row + 6; ++near) {
                average += (pushed[near].measured[k] - undisturbed[near].measured[k]) / 13;
            }
            largest[row] = std::max(largest[row], std::abs(average) / deviation);
        }
    }
    return largest;
}

/// Largest difference of the runs within 0.15 s of a row, because a contact lasts for more than one tick.
double difference_near(const std::vector<double>& difference, std::size_t row) {
    constexpr std::size_t reach = 18;
    const std::size_t first = row > reach ? row - reach : 0;
    const std::size_t last = std::min(row + reach + 1, difference.size());
    return *std::max_element(difference.begin() + static_cast<std::ptrdiff_t>(first),
                             difference.begin() + static_cast<std::ptrdiff_t>(last));
}

void check_errors(const Demo& demo) {
    // Errors of a plain random-feature RLS with 400 features and 8 lags from positions only.
    constexpr std::array<double, 6> reference{.24, .13, .14, .25, .33, .42};
    REQUIRE(demo.slow().size() == 10264);
    REQUIRE(2 * demo.model.features.count <= 800);
    for (std::size_t k = 0; k < 6; ++k) {
        CAPTURE(k + 1);
        CHECK(normalised_error(demo.slow(), demo.slow().size() / 2, k) < 0.97 * reference[k]);
    }
}

void check_pushes(const Demo& demo) {
    for (const auto& [from, to] : {std::pair{8.3, 8.9}, std::pair{11.5, 12.2}, std::pair{15.6, 16.5}}) {
        CAPTURE(from, to);
        const auto count =
            std::ranges::count_if(demo.pushed(), [&, first = from, last = to](const Tick& tick) {
                return tick.t >= first && tick.t <= last && demo.contradicts(tick);
            });
        CHECK(count >= 10); // 0.08 s
    }
}

void check_silence(const Demo& demo) {
    CHECK(longest_run_of_contradictions(demo, demo.slow(), demo.slow().size() / 2) < 2);
    CHECK(longest_run_of_contradictions(demo, demo.undisturbed(), 0) < 2);
    const std::vector<double> difference = difference_of_runs(demo.pushed(), demo.undisturbed());
    for (std::size_t row = 1; row < difference.size(); ++row) {
        if (demo.contradicts(demo.pushed()[row]) && demo.contradicts(demo.pushed()[row - 1])) {
            CAPTURE(demo.pushed()[row].t, demo.pushed()[row].nis);
            CHECK(difference_near(difference, row) > 1);
        }
    }
}

} // namespace

TEST_CASE("UR5 motor currents are predicted from positions with innovations that rise only at pushes") {
    const Demo demo(1);
    INFO("one-step errors over the second half of No6");
    check_errors(demo);
    INFO("the innovation rises where a person pushes");
    check_pushes(demo);
    INFO("the innovation does not rise where nobody pushes");
    check_silence(demo);
}

TEST_CASE("the results for the UR5's motor currents do not depend on the random features", "[.long]") {
    for (int seed = 2; seed <= 6; ++seed) {
        CAPTURE(seed);
        const Demo demo(seed);
        check_errors(demo);
        check_pushes(demo);
    }
}
