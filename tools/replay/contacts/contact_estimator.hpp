// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/contact_calibration.hpp"
#include "dfdyn/monitor/contact_detector.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/model/model.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A contact on the clock of the samples.
struct DetectedContact {
    std::int64_t start_ns = 0;
    std::int64_t end_ns = 0; ///< at a gap: the last sample before it; 0: the recording ended before
    int joint = 0;           ///< from 0: the largest deviation in units of its limit at the start
    double peak = 0;         ///< largest deviation of this joint, with its sign, in the output's unit
    bool persistent = false; ///< it did not end, and counts as a change of the arm
};

/// Limits of a detector, and whether they are measured during operation first.
struct ContactSetup {
    ContactModel limits;
    double calibration_s = 0;                     ///< duration of a dfdyn::ContactCalibration, s; 0: none
    double rate_per_hour = contact_rate_per_hour; ///< of false contacts, for the calibration
};

/// A detector with its limits, for any number of joints.
class ContactWatch {
  public:
    using Detector = ContactDetector<float, dynamic>;
    using Calibration = ContactCalibration<float, dynamic>;

    explicit ContactWatch(const ContactSetup& setup);
    ContactWatch(const ContactWatch&) = delete; // the detector refers to the limits
    ContactWatch& operator=(const ContactWatch&) = delete;

    /// Adds a tick. Returns true during a contact, which ends a calibration: the motion after it is not that
    /// of the work. Allocates nothing.
    bool tick(std::int64_t time_ns, std::span<const float> position, std::span<const float> error,
              std::span<const float> prediction, std::span<const float> standard_deviation) {
        const bool contact = detector_.tick(time_ns, position.data(), error.data(), prediction.data(),
                                            standard_deviation.data());
        if (calibration_ != nullptr) {
            calibration_->tick(time_ns, detector_);
            if (contact) {
                calibration_->abandon();
            }
        }
        return contact;
    }
    /// Registers a tick without a prediction or a measurement. Returns true during a contact.
    bool skip(std::int64_t time_ns) {
        detector_.skip(time_ns);
        return detector_.contact();
    }
    void interrupt() { detector_.interrupt(); }
    const Detector& detector() const { return detector_; }
    const Calibration* calibration() const { return calibration_.get(); } ///< null: none

  private:
    std::vector<ContactLimits<float>> limits_;
    std::unique_ptr<Calibration> calibration_;
    Detector detector_;
};

/// Limits that no deviation reaches.
ContactModel unlimited_contact(std::size_t joints);

/// Returns `contact` with limits `factor` times as large.
ContactModel scaled_contact(ContactModel contact, double factor);

/// Returns `contact` with limits for this rate of false contacts per hour, > 0. Requires a `rate_slope`.
ContactModel contact_at_rate(const ContactModel& contact, double per_hour);

/// Returns the limits of `model` for a rate of false contacts per hour; none: the rate of the training.
/// Throws InputError, naming `source`, if the model has no limits, or if they have no other rate.
ContactModel contact_limits(const TrainedModel& model, std::optional<double> per_hour,
                            const std::string& source);

/// Returns `trained` with the limits of a finished calibration: contact_at_rate() gives the measured ones for
/// `per_hour`, the rate of the calibration.
ContactModel measured_contact(ContactModel trained, const ContactWatch::Calibration& calibration,
                              double per_hour);

/// Returns measured - predicted of each output. Requires both.
std::vector<float> prediction_errors(const MeasuredSample& sample, const Tick& tick);

/// An estimator that detects contacts.
class ContactEstimator : public RuntimeEstimator {
  public:
    /// Returns the newest 4096 contacts since the last call, and removes them.
    virtual std::vector<DetectedContact> take_contacts() = 0;
    /// Returns the detector's state after the last tick. Allocates nothing.
    virtual const ContactWatch::Detector& detector() const = 0;
    /// Returns the calibration of its limits; null: none.
    virtual const ContactWatch::Calibration* calibration() const = 0;
};

/// Returns an estimator that detects contacts. It learns neither during a contact nor while all joints are at
/// rest.
std::unique_ptr<ContactEstimator> with_contacts(std::unique_ptr<RuntimeEstimator> estimator,
                                                const ContactSetup& setup);

} // namespace dfdyn::tools
