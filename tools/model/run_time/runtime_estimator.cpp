// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/runtime_estimator.hpp"

#include "tools/model/run_time/combined_estimator.hpp"
#include "tools/model/run_time/host_model.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

using Clock = std::chrono::steady_clock;

template <int count>
void copy(std::span<const double> values, Storage<float, count>& storage) {
    std::ranges::transform(values, storage.begin(), [](double x) { return static_cast<float>(x); });
}

template <int count>
Storage<float, count> zeros(int size) {
    return Storage<float, count>::zeros(extent<count>(size));
}

/// Returns an empty sample of a model, with derivatives if the model uses them.
template <class Host>
typename Host::Sample empty_sample(int joints, int outputs) {
    typename Host::Sample sample{};
    sample.position = zeros<Host::joints>(joints);
    sample.output = zeros<Host::outputs>(outputs);
    if constexpr (requires { sample.velocity; }) {
        sample.velocity = zeros<Host::joints>(joints);
        sample.acceleration = zeros<Host::joints>(joints);
    }
    return sample;
}

template <class Host>
class EstimatorOf final : public RuntimeEstimator {
  public:
    EstimatorOf(const TrainedModel& model, bool from_prior)
        : host_(make_host_constants<Host>(model, from_prior)), estimator_(host_->constants),
          sample_(empty_sample<Host>(model.joints, output_count())),
          estimate_{outputs(), outputs(), outputs(), 0, {}}, input_cost_(cost_of_inputs(model)) {}

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        sample_.time_ns = sample.time_ns;
        copy(sample.position, sample_.position);
        copy(sample.output, sample_.output);
        sample_.output_valid = !sample.output.empty();
        if constexpr (requires { sample_.velocity; }) {
            copy(sample.velocity, sample_.velocity);
            copy(sample.acceleration, sample_.acceleration);
        }
        const auto begin = Clock::now();
        estimate_ = estimator_.tick(sample_, budget);
        const auto duration = Clock::now() - begin;
        return {std::span(estimate_.prediction.data(), size()),
                std::span(estimate_.standard_deviation.data(), size()),
                estimate_.normalised_innovation_squared, estimate_.status, duration};
    }

    bool advance(Budget budget) override { return estimator_.advance(budget); }

    bool predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        estimator_.regression().predict_with(weights.data(), prediction.data());
        bool within = true;
        for (int k = 0; k < output_count(); ++k) {
            float& mean = prediction[static_cast<std::size_t>(k)];
            mean = constants().output_offset[k] + constants().output_noise_std[k] * mean;
            if (const float limit = constants().prediction_limit[k]; limit > 0) {
                within = within && std::abs(mean) <= limit;
                mean = std::clamp(mean, -limit, limit);
            }
        }
        return within;
    }

    std::size_t weight_count() const override {
        return static_cast<std::size_t>(estimator_.regression().weight_count());
    }
    void copy_weights(std::span<float> weights) const override {
        estimator_.regression().copy_weights(weights.data());
    }

    void relearn() override { estimator_.relearn(); }
    void begin_recording() override { estimator_.restart_window(); }

    std::vector<std::byte> snapshot() const override {
        std::vector<std::byte> bytes(estimator_.snapshot_bytes());
        if (estimator_.snapshot(bytes) != SnapshotResult::ok) {
            throw std::logic_error("an estimator that its own snapshot does not hold");
        }
        return bytes;
    }

    bool restore(std::span<const std::byte> snapshot) override {
        return estimator_.restore(snapshot) == SnapshotResult::ok;
    }

    std::size_t state_bytes() const override { return estimator_.snapshot_bytes(); }
    Cost cost() const override {
        Cost cost = Embedded::cost(constants().sizes);
        cost.predict += input_cost_;
        return cost;
    }

  private:
    using Embedded = Estimator<Host>;

    /// Cost of the input maps whose kind is chosen at run time, which the embedded estimator's cost does not
    /// include.
    static std::int64_t cost_of_inputs(const TrainedModel& model) {
        return (model.features.count > 0 ? cost_of_input(model.input, model.joints) : 0) +
               (model.physics ? cost_of_input(model.physics->motion, model.joints) : 0);
    }
    const typename Host::Constants& constants() const { return host_->constants; }
    int output_count() const { return constants().sizes.output_count; }
    std::size_t size() const { return static_cast<std::size_t>(output_count()); }
    Storage<float, Host::outputs> outputs() const { return zeros<Host::outputs>(output_count()); }

    std::unique_ptr<HostConstants<Host>> host_;
    Embedded estimator_;
    typename Embedded::Sample sample_;
    typename Embedded::Estimate estimate_;
    std::int64_t input_cost_;
};

} // namespace

std::unique_ptr<RuntimeEstimator> make_estimator(const TrainedModel& model, bool from_prior) {
    return with_host_type(
        model, [&]<class Model>(std::type_identity<Model> /*type*/) -> std::unique_ptr<RuntimeEstimator> {
            return std::make_unique<EstimatorOf<Model>>(model, from_prior);
        });
}

std::unique_ptr<RuntimeEstimator> make_estimator(std::span<const TrainedModel> models, bool from_prior) {
    if (models.size() == 1) {
        return make_estimator(models.front(), from_prior);
    }
    std::vector<CombinationMember> members;
    for (const TrainedModel& model : models) {
        members.push_back({make_estimator(model, from_prior), model.limits.innovation,
                           model.outputs.noise_std, model.extrapolation.has_value()});
    }
    return combine(std::move(members), models.front().outputs.names.size(), models.front().sample_period_s);
}

} // namespace dfdyn::tools
