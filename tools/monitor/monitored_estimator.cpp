// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/monitored_estimator.hpp"

#include "dfdyn/monitor/centred_motion.hpp"
#include "dfdyn/monitor/delayed_weights.hpp"
#include "dfdyn/monitor/monitor.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/model/run_time/estimator_decorator.hpp"
#include "tools/model/run_time/host_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double block_s = 0.1;
constexpr double motion_window_s = 0.12;
constexpr double report_s = 2;
constexpr double longest_s = 20;
constexpr double refresh_s = 3;
constexpr float sign_velocity = 0.02F;             // rad/s
constexpr SpeedClasses<float> speed{0.03F, 0.15F}; // rad/s

template <class Arm>
using HostMonitor = Monitor<float, Arm, dynamic>;

/// Even, at least 4.
int motion_lags(double period_s) {
    return std::max(4, 2 * static_cast<int>(std::lround(motion_window_s / period_s / 2)));
}

template <class Arm>
typename HostMonitor<Arm>::Constants monitor_constants(const MonitorSetup& setup) {
    typename HostMonitor<Arm>::Constants constants{};
    const int joints = static_cast<int>(setup.chain.joints.size());
    const int outputs = static_cast<int>(setup.outputs.size());
    constants.sizes = {extent<Arm::joints>(joints), extent<Arm::outputs>(outputs),
                       extent<Arm::bodies>(body_count(setup.chain))};
    constants.lags = {motion_lags(setup.sample_period_s)};
    constants.chain = host_chain<float, Arm>(setup.chain);
    const int window = constants.lags + 1;
    std::vector<float> rows(3 * static_cast<std::size_t>(window));
    centred_motion_rows(constants.lags, static_cast<float>(setup.sample_period_s), rows.data());
    constants.motion.rows = Storage<float, dynamic>::zeros({3 * window});
    to_difference_form(rows.data(), 3, constants.lags, constants.motion.rows.data());
    constants.motion.scale = Storage<float, dynamic>::zeros({3 * joints});
    std::ranges::fill(constants.motion.scale, 1.0F);
    constants.output_gain = Storage<float, Arm::outputs>::zeros(extent<Arm::outputs>(outputs));
    std::ranges::transform(setup.output_gain, constants.output_gain.begin(),
                           [](double x) { return static_cast<float>(x); });
    for (int i = 0; i < 3; ++i) {
        constants.tip[i] = static_cast<float>(setup.tip_placement.translation()[i]);
    }
    constants.sign_velocity = sign_velocity;
    constants.speed = speed;
    constants.block_samples = std::max(1, static_cast<int>(std::lround(block_s / setup.sample_period_s)));
    const double blocks_per_s = 1 / (setup.sample_period_s * constants.block_samples);
    constants.blocks_between_false_alarms = static_cast<float>(3600 * setup.false_alarm_hours * blocks_per_s);
    constants.report_blocks = static_cast<int>(std::lround(report_s * blocks_per_s));
    constants.longest_blocks = static_cast<int>(std::lround(longest_s * blocks_per_s));
    constants.refresh_blocks = static_cast<int>(std::lround(refresh_s * blocks_per_s));
    return constants;
}

template <class Arm>
class Monitored final : public EstimatorDecorator<MonitoredEstimator> {
  public:
    Monitored(std::unique_ptr<RuntimeEstimator> watched, const MonitorSetup& setup)
        : EstimatorDecorator(std::move(watched)), setup_(setup), constants_(monitor_constants<Arm>(setup)),
          monitor_(constants_), held_(Extent<dynamic>{static_cast<int>(estimator().weight_count())}),
          held_prediction_(setup.outputs.size()), position_(setup.chain.joints.size()),
          output_(setup.outputs.size()), changes_(kept, monitor_.change()) {
        verdict_.moved.resize(setup.outputs.size());
        refresh();
    }

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        const Tick tick = estimator().tick(sample, budget);
        if (tick.status.predicted() && measured(tick.status.learning)) {
            watch(sample, tick);
        } else {
            monitor_.interrupt();
        }
        refresh();
        return tick;
    }
    bool advance(Budget budget) override {
        const bool idle = estimator().advance(budget);
        refresh();
        return idle;
    }
    void begin_recording() override {
        estimator().begin_recording();
        monitor_.restart();
        known_ = false;
    }
    /// Includes the prediction with the delayed weights, and the monitor.
    Cost cost() const override {
        Cost cost = estimator().cost();
        cost.predict += cost.predict + HostMonitor<Arm>::cost(constants_.sizes, constants_.lags);
        return cost;
    }

    std::vector<NamedChange> changes() const override {
        std::vector<NamedChange> result;
        for (std::size_t number = count_ > kept ? count_ - kept : 0; number < count_; ++number) {
            result.push_back(named(changes_[number % kept], setup_));
        }
        return result;
    }
    std::vector<NamedChange> take_changes() override {
        std::vector<NamedChange> taken = changes();
        count_ = 0;
        known_ = false;
        return taken;
    }

    const Verdict* take_verdict() override {
        return std::exchange(verdict_is_new_, false) ? &verdict_ : nullptr;
    }

  private:
    static constexpr std::size_t kept = 256; ///< changes; older ones are removed

    static bool measured(Reason learning) {
        return learning != Reason::output_missing && learning != Reason::output_not_finite &&
               learning != Reason::output_out_of_range;
    }

    void watch(const MeasuredSample& sample, const Tick& tick) {
        const auto narrow = [](double x) { return static_cast<float>(x); };
        std::ranges::transform(sample.position, position_.begin(), narrow);
        std::ranges::transform(sample.output, output_.begin(), narrow);
        estimator().predict_with({held_.older(), weight_count()}, held_prediction_);
        if (monitor_.tick({sample.time_ns, position_.data(), output_.data(), tick.prediction.data(),
                           tick.standard_deviation.data(), held_prediction_.data()})) {
            note();
        }
    }

    /// Adds a change at its first report and replaces it at every later one. Allocates nothing, for ticks of
    /// a control loop.
    void note() {
        count_ += known_ && count_ > 0 ? 0 : 1;
        changes_[(count_ - 1) % kept] = monitor_.change();
        known_ = monitor_.changing();
        take_down(monitor_.change());
    }

    void take_down(const typename HostMonitor<Arm>::Change& change) {
        const int joints = static_cast<int>(position_.size());
        verdict_.number = count_;
        verdict_.cause = change.cause;
        verdict_.confidence = static_cast<double>(change.confidence);
        verdict_.joint = change.where < joints ? change.where : change.where - joints;
        for (std::size_t k = 0; k < verdict_.moved.size(); ++k) {
            const auto moved = static_cast<double>(change.bias[static_cast<int>(k)]);
            verdict_.moved[k] = change.cause == Cause::bias ? moved : 0;
        }
        verdict_is_new_ = true;
    }

    /// Refreshes the delayed weights, if they are due and the estimator has nothing left to learn.
    void refresh() {
        while (monitor_.refresh_due() && estimator().advance(Budget::predict_only())) {
            estimator().copy_weights({held_.refresh(), weight_count()});
            monitor_.refreshed();
        }
    }

    MonitorSetup setup_;
    typename HostMonitor<Arm>::Constants constants_;
    HostMonitor<Arm> monitor_;
    DelayedWeights<float, dynamic> held_;
    std::vector<float> held_prediction_, position_, output_;
    std::vector<typename HostMonitor<Arm>::Change> changes_;
    std::size_t count_ = 0; ///< of all changes, including removed ones
    bool known_ = false;    ///< the last change is the present one
    Verdict verdict_;
    bool verdict_is_new_ = false;
};

} // namespace

MonitorSetup monitor_setup(const TrainedModel& model, const Robot* robot, const std::string& source) {
    MonitorSetup setup;
    setup.outputs = model.outputs.names;
    setup.sample_period_s = model.sample_period_s;
    setup.output_gain.assign(setup.outputs.size(), 1);
    const auto joints = static_cast<std::size_t>(model.joints);
    const bool wrench = setup.outputs == output_names(OutputKind::wrench, joints);
    if (robot != nullptr) {
        if (robot->joints.size() != joints) {
            throw InputError(source + ": expected a robot of " + std::to_string(joints) +
                             " joints as the model, found " + std::to_string(robot->joints.size()));
        }
        setup.chain = chain_model(*robot, wrench ? OutputKind::wrench : OutputKind::joint_torque);
        setup.tip_placement = robot->tip_placement;
    } else if (!model.physics) {
        throw InputError(source + ": expected a model with physics, or --robot and --tip, found neither");
    }
    if (model.physics) {
        setup.chain = model.physics->chain;
        setup.output_gain = model.physics->output_gain;
    }
    return setup;
}

std::unique_ptr<MonitoredEstimator> monitored(std::unique_ptr<RuntimeEstimator> estimator,
                                              const MonitorSetup& setup) {
    if (setup.chain.sensor) {
        return std::make_unique<Monitored<WrenchArm>>(std::move(estimator), setup);
    }
    return std::make_unique<Monitored<TorqueArm>>(std::move(estimator), setup);
}

} // namespace dfdyn::tools
