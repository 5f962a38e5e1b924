// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_estimator.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace contact_estimator_test {

using namespace dfdyn::tools;
using dfdyn::Reason;

constexpr std::int64_t period_ns = 4'000'000;

/// An estimator that predicts 0 for one output, with a given status.
class PredictsZero final : public RuntimeEstimator {
  public:
    explicit PredictsZero(Reason prediction) : prediction_(prediction) {}

    Tick tick(const MeasuredSample& /*sample*/, dfdyn::Budget /*budget*/) override {
        Tick tick;
        tick.prediction = tick.standard_deviation = zero_;
        tick.status.prediction = prediction_;
        return tick;
    }
    bool advance(dfdyn::Budget /*budget*/) override { return true; }
    bool predict_with(std::span<const float> /*weights*/, std::span<float> /*prediction*/) const override {
        return true;
    }
    std::size_t weight_count() const override { return 0; }
    void copy_weights(std::span<float> /*weights*/) const override {}
    void begin_recording() override {}
    std::vector<std::byte> snapshot() const override { return {}; }
    bool restore(std::span<const std::byte> /*snapshot*/) override { return false; }
    std::size_t state_bytes() const override { return 0; }
    dfdyn::Cost cost() const override { return {}; }

  private:
    Reason prediction_;
    std::array<float, 1> zero_{};
};

std::unique_ptr<ContactEstimator> detector_of(Reason prediction) {
    return with_contacts(std::make_unique<PredictsZero>(prediction), {{{1, 1, 1}, {0.1, 0.1, 0.1}}});
}

/// Ticks from `first` to before `last` of a joint that turns at 0.5 rad/s, with a constant output.
void run(ContactEstimator& estimator, std::int64_t first, std::int64_t last, double output) {
    for (std::int64_t number = first; number < last; ++number) {
        const std::array position{0.002 * static_cast<double>(number)};
        const std::array measured{output};
        estimator.tick({number * period_ns, position, {}, {}, measured});
    }
}

TEST_CASE("a contact that a gap interrupts ends at the last sample before the gap") {
    const auto estimator = detector_of(Reason::ok);
    run(*estimator, 0, 250, 0);
    run(*estimator, 250, 300, 10);
    REQUIRE(estimator->detector().contact());
    estimator->begin_recording();
    run(*estimator, 1000, 1250, 0);
    run(*estimator, 1250, 1300, 10);
    REQUIRE(estimator->detector().contact());
    const std::vector<DetectedContact> contacts = estimator->take_contacts();
    REQUIRE(contacts.size() == 2);
    CHECK(contacts[0].start_ns > 250 * period_ns);
    CHECK(contacts[0].end_ns == 299 * period_ns);
    CHECK_FALSE(contacts[0].persistent);
    CHECK(contacts[1].end_ns == 0); // it lasts to the end of the recording
}

TEST_CASE("a push is a contact also while the prediction is at the model's bound") {
    for (const Reason prediction : {Reason::ok, Reason::prediction_bounded}) {
        const auto estimator = detector_of(prediction);
        run(*estimator, 0, 250, 0);
        run(*estimator, 250, 300, 10);
        CHECK(estimator->take_contacts().size() == 1);
    }
    const auto blind = detector_of(Reason::window_filling);
    run(*blind, 0, 250, 0);
    run(*blind, 250, 300, 10);
    CHECK(blind->take_contacts().empty());
}

} // namespace contact_estimator_test
