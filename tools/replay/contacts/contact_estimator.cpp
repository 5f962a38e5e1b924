// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double unlimited = 1e30;

void set_errors(const MeasuredSample& sample, const Tick& tick, std::span<float> error) {
    for (std::size_t k = 0; k < error.size(); ++k) {
        error[k] = static_cast<float>(sample.output[k]) - tick.prediction[k];
    }
}

class Watched final : public ContactEstimator {
  public:
    Watched(std::unique_ptr<HostEstimator> estimator, const ContactModel& contact)
        : estimator_(std::move(estimator)), watch_(contact),
          position_(contact.limit.size() / joint_motion_count), error_(position_.size()), contacts_(kept) {}

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        const Tick tick = estimator_->tick(sample, budget);
        note(sample.time_ns, watch(sample, tick));
        return tick;
    }
    bool advance(Budget budget) override { return estimator_->advance(budget); }
    bool predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        return estimator_->predict_with(weights, prediction);
    }
    std::size_t weight_count() const override { return estimator_->weight_count(); }
    void copy_weights(std::span<float> weights) const override { estimator_->copy_weights(weights); }
    void relearn() override { estimator_->relearn(); }
    void begin_recording() override {
        estimator_->begin_recording();
        watch_.interrupt();
        during_ = false;
    }
    std::vector<std::byte> snapshot() const override { return estimator_->snapshot(); }
    bool restore(std::span<const std::byte> snapshot) override { return estimator_->restore(snapshot); }
    std::size_t state_bytes() const override { return estimator_->state_bytes(); }
    Cost cost() const override {
        Cost cost = estimator_->cost();
        cost.predict += ContactWatch::Detector::cost * watch_.detector().size();
        return cost;
    }

    std::vector<DetectedContact> take_contacts() override {
        std::vector<DetectedContact> taken;
        for (std::size_t number = count_ > kept ? count_ - kept : 0; number < count_; ++number) {
            taken.push_back(contacts_[number % kept]);
        }
        count_ = 0;
        during_ = false;
        return taken;
    }

  private:
    static constexpr std::size_t kept = 4096;

    bool watch(const MeasuredSample& sample, const Tick& tick) {
        if (!tick.status.predicted() || sample.output.empty()) {
            watch_.interrupt();
            return false;
        }
        std::ranges::transform(sample.position, position_.begin(),
                               [](double x) { return static_cast<float>(x); });
        set_errors(sample, tick, error_);
        return watch_.tick(sample.time_ns, position_, error_);
    }

    void note(std::int64_t time_ns, bool contact) {
        if (contact && !during_) {
            contacts_[count_++ % kept] = {time_ns, 0, watch_.detector().joint(), 0, false};
        }
        if (contact) {
            DetectedContact& now = contacts_[(count_ - 1) % kept];
            const auto deviation = static_cast<double>(watch_.detector().deviation(now.joint));
            now.peak = std::abs(deviation) > std::abs(now.peak) ? deviation : now.peak;
        } else if (during_) {
            DetectedContact& last = contacts_[(count_ - 1) % kept];
            last.end_ns = time_ns;
            last.persistent = watch_.detector().persistent();
        }
        during_ = contact;
    }

    std::unique_ptr<HostEstimator> estimator_;
    ContactWatch watch_;
    std::vector<float> position_, error_;
    std::vector<DetectedContact> contacts_;
    std::size_t count_ = 0; ///< of all contacts, including removed ones
    bool during_ = false;
};

std::vector<ContactLimits<float>> limits_of(const ContactModel& contact) {
    std::vector<ContactLimits<float>> limits(contact.limit.size() / joint_motion_count);
    for (std::size_t i = 0; i < contact.limit.size(); ++i) {
        ContactLimits<float>& joint = limits[i / joint_motion_count];
        joint.limit[i % joint_motion_count] = static_cast<float>(contact.limit[i]);
        joint.usual[i % joint_motion_count] = static_cast<float>(contact.usual[i]);
    }
    return limits;
}

} // namespace

ContactWatch::ContactWatch(const ContactModel& contact) : limits_(limits_of(contact)) {
    detector_ = std::make_unique<Detector>(Extent<dynamic>{static_cast<int>(limits_.size())}, limits_.data());
}

ContactModel unlimited_contact(std::size_t joints) {
    return {std::vector<double>(joints * joint_motion_count, unlimited),
            std::vector<double>(joints * joint_motion_count, 0)};
}

std::vector<float> prediction_errors(const MeasuredSample& sample, const Tick& tick) {
    std::vector<float> errors(sample.output.size());
    set_errors(sample, tick, errors);
    return errors;
}

std::unique_ptr<ContactEstimator> with_contacts(std::unique_ptr<HostEstimator> estimator,
                                                const ContactModel& contact) {
    return std::make_unique<Watched>(std::move(estimator), contact);
}

} // namespace dfdyn::tools
