// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/task/task.hpp"

#include <Eigen/Core>

#include <utility>

namespace dfdyn::tools {

class Multisine final : public Task {
  public:
    Multisine(const MultisineTask& model, double period_s, std::uint64_t seed);
    Reference next() override;

  private:
    MultisineTask model_;
    double period_s_;
    Eigen::MatrixXd phase_; ///< joints × tones, rad
    long step_ = 0;
};

class Tones final : public Task {
  public:
    Tones(TonesTask model, double period_s) : model_(std::move(model)), period_s_(period_s) {}
    Reference next() override;

  private:
    TonesTask model_;
    double period_s_;
    long step_ = 0;
};

class PointToPoint final : public Task {
  public:
    PointToPoint(PointToPointTask model, double period_s) : model_(std::move(model)), period_s_(period_s) {}
    Reference next() override;

  private:
    PointToPointTask model_;
    double period_s_;
    long step_ = 0;
};

} // namespace dfdyn::tools
