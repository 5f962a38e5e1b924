// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/block_noise.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>

namespace block_noise_test {

using namespace dfdyn;

/// A joint that rests and moves in turn. Its residuals are large and slow at rest, and small and fast in
/// motion.
struct Joint {
    static constexpr std::array<double, 3> scale{2, 0.7, 0.3}, alike{0.9, 0.4, 0.1};
    int speed_class = 2, last_class = -1;
    double unit = 0; ///< residual of unit deviation

    double next(std::mt19937_64& engine) {
        std::normal_distribution<double> normal;
        last_class = speed_class;
        speed_class = std::uniform_int_distribution<int>(0, 14)(engine) == 0
                          ? std::uniform_int_distribution<int>(0, 2)(engine)
                          : speed_class;
        const auto c = static_cast<std::size_t>(speed_class);
        const double a = speed_class == last_class ? alike[c] : 0;
        unit = a * unit + std::sqrt(1 - a * a) * normal(engine);
        return scale[c] * unit;
    }
};

TEMPLATE_TEST_CASE("scale and autocorrelation are estimated per class of speed, and whitening removes both",
                   "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    BlockNoise<TestType> noise;
    Joint joint;
    TestType before = 0;
    double square = 0, product = 0, last = 0;
    int count = 0;
    for (int block = 0; block < 30000; ++block) {
        const auto value = static_cast<TestType>(joint.next(engine));
        const auto whitening = noise.whitening(joint.speed_class, joint.last_class);
        const auto white = static_cast<double>(whitening.of(value, before));
        if (block > 3000) {
            square += white * white;
            product += white * last;
            ++count;
        }
        last = white;
        noise.learn(value, before, joint.speed_class, joint.last_class);
        before = value;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(noise.known(static_cast<int>(c)));
        CHECK(noise.scale(static_cast<int>(c)) == Approx(Joint::scale[c]).epsilon(0.15));
        CHECK(noise.autocorrelation(static_cast<int>(c)) == Approx(Joint::alike[c]).margin(0.12));
    }
    CHECK(noise.smallest() == noise.scale(2));
    CHECK(square / count == Approx(1).epsilon(0.1));
    CHECK(std::abs(product / square) < 0.1);
}

TEST_CASE("a rarely visited class of speed has no estimate, and its blocks are ignored", "[monitor]") {
    BlockNoise<float> noise;
    CHECK(noise.smallest() == 0);
    for (int block = 0; block < 29; ++block) {
        noise.learn(1, 1, 0, 0);
    }
    CHECK_FALSE(noise.known(0));
    CHECK(noise.whitening(0, 0).of(5, 1) == 0);
    noise.learn(1, 1, 0, 0);
    CHECK(noise.known(0));
    CHECK(noise.whitening(0, -1).of(5, 1) > 1); // after a gap only the scale is used
    CHECK(noise.whitening(1, 0).of(5, 1) == 0);
}

TEST_CASE("bursts have little influence, and a scale stays positive", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<float> normal;
    BlockNoise<float> noise;
    float before = 0;
    for (int block = 0; block < 5000; ++block) {
        const float value = block % 50 == 49 ? 1e6F : normal(engine);
        noise.learn(value, before, 2, 2);
        before = value;
    }
    CHECK(noise.scale(2) < 1.3F);
    for (int block = 0; block < 100000; ++block) {
        noise.learn(0, 0, 2, 2);
    }
    CHECK(noise.scale(2) > 0);
    CHECK(std::isfinite(noise.whitening(2, 2).of(1, 0)));
}

} // namespace block_noise_test
