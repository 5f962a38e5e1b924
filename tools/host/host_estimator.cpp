// SPDX-License-Identifier: Apache-2.0
#include "tools/host/host_estimator.hpp"

#include "tools/host/host_model.hpp"

#include <algorithm>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

using Clock = std::chrono::steady_clock;

template <class Input>
class EstimatorOf final : public HostEstimator {
  public:
    EstimatorOf(const TrainedModel& model, bool from_prior)
        : host_(make_host_constants<Input>(model, from_prior)),
          estimator_(host_->constants), sample_{0, zeros(model.joints), zeros(output_count()), true},
          estimate_{zeros(output_count()), zeros(output_count()), zeros(output_count()), 0, {}} {}

    Tick tick(std::int64_t time_ns, std::span<const double> position,
              std::span<const double> output) override {
        sample_.time_ns = time_ns;
        std::ranges::transform(position, sample_.position.begin(),
                               [](double q) { return static_cast<float>(q); });
        std::ranges::transform(output, sample_.output.begin(),
                               [](double y) { return static_cast<float>(y); });
        const auto begin = Clock::now();
        estimate_ = estimator_.tick(sample_, Budget::unlimited());
        const auto duration = Clock::now() - begin;
        return {estimate_.prediction, estimate_.standard_deviation, estimate_.normalised_innovation_squared,
                estimate_.status, duration};
    }

    void predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        const int columns = column_count();
        for (int k = 0; k < output_count(); ++k) {
            prediction[static_cast<std::size_t>(k)] =
                constants().output_offset[k] +
                constants().output_noise_std[k] *
                    detail::dot(weights.data() + k * columns, estimator_.columns(), columns);
        }
    }

    void copy_weights(std::span<float> weights) const override {
        for (int k = 0; k < output_count(); ++k) {
            std::copy_n(estimator_.learner().weights(k), column_count(),
                        weights.begin() + k * column_count());
        }
    }

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
    Cost cost() const override { return Embedded::cost(constants().sizes); }

  private:
    using Host = HostModel<Input>;
    using Embedded = Estimator<Host>;

    static Storage<float, dynamic> zeros(int count) {
        return Storage<float, dynamic>::zeros(Extent<dynamic>{count});
    }
    const typename Host::Constants& constants() const { return host_->constants; }
    int output_count() const { return constants().sizes.output_count; }
    int column_count() const { return constants().sizes.column_count(); }

    std::unique_ptr<HostConstants<Host>> host_;
    Embedded estimator_;
    typename Embedded::Sample sample_;
    typename Embedded::Estimate estimate_;
};

} // namespace

std::unique_ptr<HostEstimator> make_estimator(const TrainedModel& model, bool from_prior) {
    switch (model.input.kind) {
    case InputKind::STD:
        return std::make_unique<EstimatorOf<Standard<dynamic>>>(model, from_prior);
    case InputKind::DF:
        return std::make_unique<EstimatorOf<DerivativeFree<dynamic>>>(model, from_prior);
    case InputKind::DFW:
        return std::make_unique<EstimatorOf<DerivativeFreeWeighted<dynamic>>>(model, from_prior);
    case InputKind::DFR:
        return std::make_unique<EstimatorOf<DerivativeFreeReduced<dynamic, dynamic>>>(model, from_prior);
    case InputKind::DFSR:
        return std::make_unique<EstimatorOf<DerivativeFreeStructured<dynamic>>>(model, from_prior);
    }
    throw std::logic_error("an input kind without an estimator");
}

} // namespace dfdyn::tools
