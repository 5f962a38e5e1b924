// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_estimator.hpp"

#include "tools/base/text/error.hpp"
#include "tools/model/run_time/contact_constants.hpp"
#include "tools/model/run_time/estimator_decorator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double least_scale = 0.2; // of limits at a high rate

void set_errors(const MeasuredSample& sample, const Tick& tick, std::span<float> error) {
    for (std::size_t k = 0; k < error.size(); ++k) {
        error[k] = static_cast<float>(sample.output[k]) - tick.prediction[k];
    }
}

class Watched final : public EstimatorDecorator<ContactEstimator> {
  public:
    Watched(std::unique_ptr<RuntimeEstimator> estimator, const ContactSetup& setup)
        : EstimatorDecorator(std::move(estimator)), watch_(setup),
          position_(setup.limits.limit.size() / joint_motion_count), error_(position_.size()),
          contacts_(kept) {}

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        const Tick tick =
            estimator().tick(sample, watch_.detector().informative() ? budget : Budget::predict_only());
        const double step_s = 1e-9 * static_cast<double>(sample.time_ns - last_ns_);
        const bool gap = step_s > static_cast<double>(ContactWatch::Detector::longest_gap_s);
        const bool contact = watch(sample, tick);
        note(gap && !contact ? last_ns_ : sample.time_ns, contact); // a contact ends before the gap
        last_ns_ = sample.time_ns;
        return tick;
    }
    void begin_recording() override {
        estimator().begin_recording();
        note(last_ns_, false); // without an end a contact would seem to last to the end of the recording
        watch_.interrupt();
    }
    Cost cost() const override {
        Cost cost = estimator().cost();
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

    const ContactWatch::Detector& detector() const override { return watch_.detector(); }
    const ContactWatch::Calibration* calibration() const override { return watch_.calibration(); }

  private:
    static constexpr std::size_t kept = 4096;

    bool watch(const MeasuredSample& sample, const Tick& tick) {
        if (!tick.status.estimated() || sample.output.empty()) {
            return watch_.skip(sample.time_ns);
        }
        std::ranges::transform(sample.position, position_.begin(),
                               [](double x) { return static_cast<float>(x); });
        set_errors(sample, tick, error_);
        return watch_.tick(sample.time_ns, position_, error_, tick.prediction, tick.standard_deviation);
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

    ContactWatch watch_;
    std::vector<float> position_, error_;
    std::vector<DetectedContact> contacts_;
    std::size_t count_ = 0; ///< of all contacts, including removed ones
    std::int64_t last_ns_ = 0;
    bool during_ = false;
};

} // namespace

ContactWatch::ContactWatch(const ContactSetup& setup)
    : limits_(contact_constants(setup.limits)),
      calibration_(setup.calibration_s > 0
                       ? std::make_unique<Calibration>(
                             Extent<dynamic>{static_cast<int>(limits_.size())}, limits_.data(),
                             static_cast<float>(setup.calibration_s), static_cast<float>(setup.rate_per_hour))
                       : nullptr),
      detector_(Extent<dynamic>{static_cast<int>(limits_.size())},
                calibration_ != nullptr ? calibration_->limits() : limits_.data()) {}

ContactModel unlimited_contact(std::size_t joints) {
    return {std::vector<double>(joints * joint_motion_count, no_contact_limit),
            std::vector<double>(joints * joint_motion_count, 0)};
}

ContactModel scaled_contact(ContactModel contact, double factor) {
    for (std::vector<double>* values : {&contact.limit, &contact.relative}) {
        for (double& value : *values) {
            value *= factor;
        }
    }
    return contact;
}

namespace {

/// Factor of a model's limits for a rate of false contacts.
double scale_at_rate(const ContactModel& contact, double per_hour) {
    return std::max(1 - contact.rate_slope * std::log(per_hour / contact_rate_per_hour), least_scale);
}

} // namespace

ContactModel contact_at_rate(const ContactModel& contact, double per_hour) {
    return scaled_contact(contact, scale_at_rate(contact, per_hour));
}

ContactModel contact_limits(const TrainedModel& model, std::optional<double> per_hour,
                            const std::string& source) {
    if (model.contact.limit.empty()) {
        throw InputError(source + ": contact detection: expected a model with limits of contacts (field " +
                         "contact, which `dfdyn train` writes for --outputs tau and i), found none");
    }
    if (!per_hour) {
        return model.contact;
    }
    if (model.contact.rate_slope == 0) {
        throw InputError(source + ": --contact-rate: expected a model with field contact.rate_slope, which " +
                         "`dfdyn train` writes, found a model of an older version");
    }
    return contact_at_rate(model.contact, *per_hour);
}

ContactModel measured_contact(ContactModel trained, const ContactWatch::Calibration& calibration,
                              double per_hour) {
    const ContactLimits<float>* const measured = calibration.limits();
    for (std::size_t i = 0; i < trained.limit.size(); ++i) {
        trained.limit[i] = measured[i / joint_motion_count].limit[i % joint_motion_count];
    }
    for (std::size_t joint = 0; joint < trained.relative.size(); ++joint) {
        trained.relative[joint] = measured[joint].relative;
    }
    return scaled_contact(trained, 1 / scale_at_rate(trained, per_hour));
}

std::vector<float> prediction_errors(const MeasuredSample& sample, const Tick& tick) {
    std::vector<float> errors(sample.output.size());
    set_errors(sample, tick, errors);
    return errors;
}

std::unique_ptr<ContactEstimator> with_contacts(std::unique_ptr<RuntimeEstimator> estimator,
                                                const ContactSetup& setup) {
    return std::make_unique<Watched>(std::move(estimator), setup);
}

} // namespace dfdyn::tools
