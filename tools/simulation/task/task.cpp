// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/task.hpp"

#include "tools/simulation/task/circle_task.hpp"
#include "tools/simulation/task/joint_space_tasks.hpp"

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
