// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/endurance_bench.hpp"

#include "dfdyn/learner/ud_covariance.hpp"
#include "tools/bench/timing/whole_tick.hpp"

#include <cmath>
#include <memory>

namespace dfdyn::tools {

namespace {

constexpr int columns = EnduranceBench::columns;
constexpr int outputs = RegressionTask::outputs;
using Learner = UdCovariance<float, columns, outputs>;
constexpr Learner::Constants constants{100, 0.9995F, nullptr};

/// Columns and targets of an arm that moves or remains stationary.
struct Motion {
    using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Matrix rows, targets;

    Motion() {
        const RegressionTask task(columns);
        rows = task.rows().cast<float>();
        targets = task.targets().cast<float>();
    }
};

void tick(Learner& learner, const Motion& motion, Eigen::Index row) {
    whole_tick(learner, motion.targets.row(row).data(), motion.rows.row(row).data());
}

/// Runs a tenth of the ticks in motion and the others at standstill.
void live(Learner& learner, const Motion& motion, std::int64_t ticks) {
    for (std::int64_t t = 0; t < ticks; ++t) {
        tick(learner, motion, 10 * t < ticks ? static_cast<Eigen::Index>(t % motion.rows.rows()) : 0);
    }
}

class Going final : public Ticking {
  public:
    Going(const Learner& learner, const Motion& motion, bool moving)
        : learner_(std::make_unique<Learner>(learner)), motion_(motion), moving_(moving) {}
    void tick() override {
        tools::tick(*learner_, motion_, row_);
        row_ = moving_ ? (row_ + 1) % motion_.rows.rows() : 0;
    }

  private:
    std::unique_ptr<Learner> learner_;
    const Motion& motion_;
    bool moving_;
    Eigen::Index row_ = 0;
};

/// Counts the denormal numbers of a learner's state.
struct DenormalCounter {
    std::int64_t count = 0;
    template <class T>
    static constexpr bool skips(int /*count*/) {
        return false;
    }
    void array(const float* values, int size) {
        for (int i = 0; i < size; ++i) {
            count += std::fpclassify(values[i]) == FP_SUBNORMAL ? 1 : 0;
        }
    }
    void positive_array(const float* values, int size) { array(values, size); }
    template <class T>
    void ranged(const T& /*value*/, T /*low*/, T /*high*/) {}
};

} // namespace

EnduranceBench run_endurance_bench(std::int64_t ticks, const RepetitionOptions& options,
                                   MultiplyAddProbe& probe,
                                   const std::function<void(double)>& on_share_done) {
    const Motion motion;
    const auto learner = std::make_unique<Learner>(constants, Extent<columns>{}, Extent<outputs>{});
    live(*learner, motion, ticks);
    const auto first = std::make_unique<Learner>(*learner);
    for (int stretch = 1; stretch < EnduranceBench::stretches; ++stretch) {
        on_share_done(static_cast<double>(stretch) / EnduranceBench::stretches);
        live(*learner, motion, ticks);
    }
    EnduranceBench bench;
    bench.ticks = ticks;
    DenormalCounter denormals;
    Learner::visit_state(*learner, denormals);
    bench.denormals = denormals.count;
    Going subjects[] = {
        {*first, motion, false}, {*learner, motion, false}, {*first, motion, true}, {*learner, motion, true}};
    Ticking* const ticking[] = {&subjects[0], &subjects[1], &subjects[2], &subjects[3]};
    const auto times = time_interleaved(ticking, options, probe, clock_cost_ns(), [](int) {});
    bench.first_standing = times[0];
    bench.last_standing = times[1];
    bench.first_moving = times[2];
    bench.last_moving = times[3];
    return bench;
}

} // namespace dfdyn::tools
