// SPDX-License-Identifier: Apache-2.0
// dfdyn_embedding runs the example. dfdyn_embedding TICKS [TICKS_IN_DOUBLE] also compares it with the ticks
// of a target, read from files with one line of integers "ticks: …" per tick.
#include "embedding.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace {

std::vector<TickOutcome> outcomes; // of this machine

bool runs_well(int (*run)(void (*)(const TickOutcome&))) {
    outcomes.clear();
    return run([](const TickOutcome& outcome) { outcomes.push_back(outcome); }) == 0;
}

/// Reads the target's lines that begin with `tag`.
std::vector<TickOutcome> read_outcomes(const char* path, const std::string& tag) {
    std::ifstream file(path);
    std::vector<TickOutcome> read;
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(tag)) {
            continue;
        }
        std::istringstream words(line.substr(tag.size()));
        TickOutcome outcome{};
        words >> outcome.predicted >> outcome.learned;
        const auto read_into = [&](std::array<double, 6>& values) {
            for (double& value : values) {
                std::uint64_t high = 0;
                std::uint64_t low = 0;
                words >> high >> low;
                value = std::bit_cast<double>(high << 32U | low);
            }
        };
        read_into(outcome.prediction);
        read_into(outcome.standard_deviation);
        if (words) {
            read.push_back(outcome);
        }
    }
    return read;
}

/// Returns the largest difference relative to the value, or to the standard deviation if that is larger, so
/// that small values are compared absolutely.
double difference(const TickOutcome& a, const TickOutcome& b) {
    double largest = a.predicted == b.predicted && a.learned == b.learned ? 0 : 1;
    for (std::size_t k = 0; k < 6 && a.predicted && b.predicted; ++k) {
        const double deviation = b.standard_deviation[k];
        const double size = std::max(std::abs(b.prediction[k]), deviation);
        largest = std::max({largest, std::abs(a.prediction[k] - b.prediction[k]) / size,
                            std::abs(a.standard_deviation[k] - deviation) / deviation});
    }
    return largest;
}

bool agrees(const char* path, const std::string& tag, double tolerance) {
    const std::vector<TickOutcome> target = read_outcomes(path, tag);
    double largest = 0;
    for (std::size_t t = 0; t < std::min(target.size(), outcomes.size()); ++t) {
        largest = std::max(largest, difference(target[t], outcomes[t]));
    }
    std::printf(
        "%s%zu ticks on the target, %zu here; they differ by %.1e of each value at most (%.0e allowed)\n",
        tag.c_str(), target.size(), outcomes.size(), largest, tolerance);
    return target.size() == outcomes.size() && largest <= tolerance;
}

} // namespace

int main(int count, char** arguments) {
    bool good = runs_well([](auto after_tick) { return run_example(after_tick); });
    if (count > 1) {
        good = agrees(arguments[1], "ticks: ", 1e-4) && good;
    }
    good = runs_well([](auto after_tick) { return run_example_in_double(after_tick); }) && good;
    if (count > 2) {
        good = agrees(arguments[2], "ticks in double: ", 1e-10) && good;
    }
    return good ? 0 : 1;
}
