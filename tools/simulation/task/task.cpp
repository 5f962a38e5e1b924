// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/task.hpp"

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/random_streams.hpp"
#include "tools/simulation/task/circle_task.hpp"

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

SmoothStep smooth_step(double time_s, double duration_s) {
    if (time_s <= 0 || time_s >= duration_s) {
        return {time_s > 0 ? 1.0 : 0.0, 0, 0};
    }
    const double u = time_s / duration_s;
    const double value = u * u * u * (10 + u * (6 * u - 15));
    const double rate = 30 * u * u * (1 - u) * (1 - u);
    const double acceleration = 60 * u * (1 - u) * (1 - 2 * u);
    return {value, rate / duration_s, acceleration / (duration_s * duration_s)};
}

namespace {

/// One number per joint without heap memory, because a control loop evaluates the reference in every tick.
using JointArray = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, largest_simulated_chain, 1>;

class Multisine final : public Task {
  public:
    Multisine(const MultisineTask& model, double period_s, std::uint64_t seed)
        : model_(model), period_s_(period_s), phase_(model.centre.size(), model.tones) {
        NormalSource source(seed, stream::task);
        for (double& phase : phase_.reshaped()) {
            const double sine = source.next();
            phase = std::atan2(sine, source.next()); // uniform on the circle
        }
    }

    Reference next() override {
        const double time_s = static_cast<double>(step_++) * period_s_;
        const SmoothStep size = smooth_step(time_s, model_.start_s);
        const double spacing =
            model_.tones > 1 ? (model_.highest_hz - model_.lowest_hz) / (model_.tones - 1) : 0;
        JointArray sum = JointArray::Zero(phase_.rows());
        JointArray rate = sum;
        JointArray acceleration = sum;
        for (Eigen::Index tone = 0; tone < phase_.cols(); ++tone) {
            const double omega =
                2 * std::numbers::pi * (model_.lowest_hz + spacing * static_cast<double>(tone));
            const JointArray angle = omega * time_s + phase_.col(tone).array();
            sum += angle.sin();
            rate += omega * angle.cos();
            acceleration -= omega * omega * angle.sin();
        }
        const JointArray amplitude = model_.amplitude.array() / static_cast<double>(model_.tones);
        return {model_.centre + (amplitude * size.value * sum).matrix(),
                amplitude * (size.rate * sum + size.value * rate),
                amplitude * (size.acceleration * sum + 2 * size.rate * rate + size.value * acceleration)};
    }

  private:
    MultisineTask model_;
    double period_s_;
    Eigen::MatrixXd phase_; ///< joints × tones, rad
    long step_ = 0;
};

class Tones final : public Task {
  public:
    Tones(TonesTask model, double period_s) : model_(std::move(model)), period_s_(period_s) {}

    Reference next() override {
        const double time_s = static_cast<double>(step_++) * period_s_;
        const SmoothStep size = smooth_step(time_s, model_.start_s);
        Reference result{model_.centre, JointVector::Zero(model_.centre.size()),
                         JointVector::Zero(model_.centre.size())};
        for (Eigen::Index joint = 0; joint < result.position.size(); ++joint) {
            for (const Tone& tone : model_.tones[static_cast<std::size_t>(joint)]) {
                const double omega = 2 * std::numbers::pi * tone.hz;
                const double angle = omega * time_s + tone.phase;
                const double value = tone.amplitude * std::sin(angle);
                const double rate = tone.amplitude * omega * std::cos(angle);
                result.position[joint] += size.value * value;
                result.velocity[joint] += size.rate * value + size.value * rate;
                result.acceleration[joint] +=
                    size.acceleration * value + 2 * size.rate * rate - size.value * omega * omega * value;
            }
        }
        return result;
    }

  private:
    TonesTask model_;
    double period_s_;
    long step_ = 0;
};

class PointToPoint final : public Task {
  public:
    PointToPoint(PointToPointTask model, double period_s) : model_(std::move(model)), period_s_(period_s) {}

    Reference next() override {
        const double time_s = static_cast<double>(step_++) * period_s_;
        const double leg_s = model_.move_s + model_.dwell_s;
        const auto leg = static_cast<std::size_t>(time_s / leg_s);
        const JointVector& from = model_.postures[leg % model_.postures.size()];
        const JointVector& to = model_.postures[(leg + 1) % model_.postures.size()];
        const SmoothStep along = smooth_step(time_s - static_cast<double>(leg) * leg_s, model_.move_s);
        return {from + along.value * (to - from), along.rate * (to - from), along.acceleration * (to - from)};
    }

  private:
    PointToPointTask model_;
    double period_s_;
    long step_ = 0;
};

struct Maker {
    const Robot& robot;
    double period_s;
    std::uint64_t seed;

    std::unique_ptr<Task> operator()(const MultisineTask& model) const {
        return std::make_unique<Multisine>(model, period_s, seed);
    }
    std::unique_ptr<Task> operator()(const TonesTask& model) const {
        return std::make_unique<Tones>(model, period_s);
    }
    std::unique_ptr<Task> operator()(const PointToPointTask& model) const {
        return std::make_unique<PointToPoint>(model, period_s);
    }
    std::unique_ptr<Task> operator()(const CircleTask& model) const {
        return std::make_unique<Circle>(model, robot, period_s, seed);
    }
};

} // namespace

std::unique_ptr<Task> make_task(const TaskModel& model, const Robot& robot, double period_s,
                                std::uint64_t seed) {
    return std::visit(Maker{robot, period_s, seed}, model);
}

} // namespace dfdyn::tools
