// SPDX-License-Identifier: Apache-2.0
// A long standstill under forgetting, followed by motion.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/slow_build.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace standstill_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using UdFloat = TestModel<float, DerivativeFreeStructured<40>, 32>;
using UdDouble = TestModel<double, DerivativeFreeStructured<40>, 32>;
using Parametric = TestParametric<float, StandardMeasured>;
using Mean = TestMean<float, DerivativeFreeStructured<40>, 32, StandardMeasured>;
using Kernel = TestKernel<float, DerivativeFreeStructured<40>, 32, StandardMeasured>;
using KernelDouble = TestKernel<double, DerivativeFreeStructured<40>, 32, StandardMeasured>;

constexpr int stop_ticks = 500;
constexpr double encoder_count = 6e-6; // 20 bits per turn

/// An arm that moves, stops smoothly, rests and starts smoothly, on the path of the moving arm at a variable
/// rate.
class StoppingArm {
  public:
    explicit StoppingArm(std::mt19937_64& engine) : engine_(&engine) {}

    template <class Model>
    typename Model::Sample moving() {
        return next<Model>(1, 0);
    }
    template <class Model>
    typename Model::Sample standing() {
        return next<Model>(0, 0);
    }
    /// Returns the sample of tick `t` of the `stop_ticks` of a stop.
    template <class Model>
    typename Model::Sample stopping(int t) {
        const auto [rate, change] = half_cosine(t);
        return next<Model>(rate, change);
    }
    template <class Model>
    typename Model::Sample starting(int t) {
        const auto [rate, change] = half_cosine(t);
        return next<Model>(1 - rate, -change);
    }

  private:
    static std::pair<double, double> half_cosine(int t) {
        const double angle = std::acos(-1.0) * t / stop_ticks;
        return {0.5 + 0.5 * std::cos(angle),
                -0.5 * std::acos(-1.0) / (stop_ticks * period_s) * std::sin(angle)};
    }

    /// Sets the motion at `rate` along the path (seconds of the moving arm per second) with the derivative
    /// `change` (1/s).
    template <class Model>
    typename Model::Sample next(double rate, double change) {
        path_s_ += rate * period_s;
        ArmState arm = moving_arm(path_s_);
        for (std::size_t i = 0; i < 2; ++i) {
            arm.acceleration[i] = arm.acceleration[i] * rate * rate + arm.velocity[i] * change;
            arm.velocity[i] *= rate;
        }
        return sample_of<Model>(arm, tick_++, *engine_);
    }

    std::mt19937_64* engine_;
    double path_s_ = 0;
    std::int64_t tick_ = 0;
};

/// Constants with low-pass filters, so that one encoder count gives less acceleration than the motion.
template <class Model>
typename Model::Constants filtered_constants(std::mt19937_64& engine, double forgetting_factor) {
    auto constants = make_constants<Model>(engine, forgetting_factor);
    if constexpr (Model::columns > 0) {
        set_filters<typename Model::Input>(constants.input, {200, 2e5, 0.8, 0.8});
    }
    return constants;
}

struct Restart {
    /// Largest variance of a parameter during the standstill, in units of the prior's.
    double largest_variance = 0;
    /// RMS innovation in the first second of motion, relative to a twin without learning at standstill.
    double first_error = 0;
    /// The same in the third second.
    double later_error = 0;
    /// RMS innovation of the twin in the first second.
    double twins_error = 0;
    bool finite = true;
};

/// Returns the learner whose variances are checked. For SPK it is the learner of the physics' parameters.
template <class Model>
const auto& watched_learner(const Estimator<Model>& estimator) {
    const auto& learner = estimator.regression().learner();
    if constexpr (requires { learner.common(); }) {
        return learner.common().learner();
    } else if constexpr (requires { learner.learner(); }) {
        return learner.learner();
    } else {
        return learner;
    }
}

/// Number of parameters of that learner.
template <class Model>
constexpr int
    watched = std::is_base_of_v<SemiparametricMean<typename Model::Physics>, typename Model::Structure>
                  ? Model::columns
                  : (Model::parameters > 0 ? Model::parameters : Model::columns);

/// Returns the largest variance of a parameter, in units of the prior's.
template <class Model>
double largest_parameter_variance(const Estimator<Model>& estimator,
                                  const typename Model::Constants& constants) {
    double prior = 0;
    if constexpr (requires { constants.learner.common; }) {
        prior = static_cast<double>(constants.learner.common.prior_variance);
    } else if constexpr (requires { constants.learner.residual; }) {
        prior = static_cast<double>(constants.learner.residual.prior_variance);
    } else {
        prior = static_cast<double>(constants.learner.prior_variance);
    }
    double largest = 0;
    for (int i = 0; i < watched<Model>; ++i) {
        largest = std::max(largest, static_cast<double>(watched_learner(estimator).parameter_variance(i)));
    }
    return largest / prior;
}

template <class Model>
class Standstill {
  public:
    Standstill(std::mt19937_64& engine, double forgetting_factor, double noise)
        : engine_(&engine), arm_(engine), constants_(filtered_constants<Model>(engine, forgetting_factor)),
          noise_(noise), estimator_(std::make_unique<Estimator<Model>>(constants_)) {}

    Restart run(int standing_ticks) {
        for (int t = 0; t < 5000; ++t) {
            tick(*estimator_, arm_.template moving<Model>());
        }
        for (int t = 1; t <= stop_ticks; ++t) {
            tick(*estimator_, arm_.template stopping<Model>(t));
        }
        auto twin = std::make_unique<Estimator<Model>>(*estimator_);
        stand(*twin, standing_ticks);
        move_on(*twin);
        return result_;
    }

  private:
    void tick(Estimator<Model>& estimator, const typename Model::Sample& sample) {
        const auto estimate = estimator.tick(sample, Budget::unlimited());
        result_.finite = result_.finite && std::isfinite(estimate.prediction[0] + estimate.prediction[1]) &&
                         !std::isnan(estimate.standard_deviation[0]);
    }

    void stand(Estimator<Model>& twin, int ticks) {
        for (int t = 0; t < ticks; ++t) {
            auto sample = arm_.template standing<Model>();
            for (auto& position : sample.position) {
                position +=
                    static_cast<typename Model::Scalar>(noise_ * static_cast<double>((*engine_)() % 2));
            }
            tick(*estimator_, sample);
            if (t % 1000 == 0) {
                result_.largest_variance =
                    std::max(result_.largest_variance, largest_parameter_variance(*estimator_, constants_));
            }
            if (ticks - t <= 50) { // only the window is updated in these ticks
                sample.output_valid = false;
                tick(twin, sample);
            }
        }
    }

    void move_on(Estimator<Model>& twin) {
        const auto [error, twins_error] = errors_of_a_second(twin, true);
        errors_of_a_second(twin, false);
        const auto [later_error, twins_later_error] = errors_of_a_second(twin, false);
        result_.first_error = error / twins_error;
        result_.later_error = later_error / twins_later_error;
        result_.twins_error = twins_error;
    }

    /// Returns the root mean square innovations of the estimator and of its twin over one second.
    std::pair<double, double> errors_of_a_second(Estimator<Model>& twin, bool starting) {
        double squares = 0;
        double twins_squares = 0;
        for (int t = 1; t <= 1000; ++t) {
            const auto sample = starting && t <= stop_ticks ? arm_.template starting<Model>(t)
                                                            : arm_.template moving<Model>();
            squares += innovation_square(*estimator_, sample);
            twins_squares += innovation_square(twin, sample);
        }
        return {std::sqrt(squares / 2000), std::sqrt(twins_squares / 2000)};
    }

    static double innovation_square(Estimator<Model>& estimator, const typename Model::Sample& sample) {
        const auto innovation = estimator.tick(sample, Budget::unlimited()).innovation;
        return std::pow(static_cast<double>(innovation[0]), 2) +
               std::pow(static_cast<double>(innovation[1]), 2);
    }

    std::mt19937_64* engine_;
    StoppingArm arm_;
    typename Model::Constants constants_;
    double noise_;
    std::unique_ptr<Estimator<Model>> estimator_;
    Restart result_;
};

template <class Model>
Restart after_standstill(std::mt19937_64& engine, double forgetting_factor, double noise, int ticks) {
    return Standstill<Model>(engine, forgetting_factor, noise).run(slow_build ? ticks / 20 : ticks);
}

/// A variance that reaches the prior's just after it was checked grows for another p - 1 samples before it is
/// bounded.
template <class Model>
double variance_bound(double forgetting_factor) {
    return std::pow(forgetting_factor, -watched<Model>) * 1.001;
}

template <class Model>
constexpr int standing_ticks =
    std::is_same_v<typename Model::Structure, Nonparametric<UdCovariance>> ? 1'000'000 : 200'000;

/// Textbook recursive least squares with exponential forgetting, dense and in double.
class TextbookForgetting {
  public:
    TextbookForgetting(int columns, double prior_variance, double forgetting_factor)
        : factor_(forgetting_factor),
          covariance_(Eigen::MatrixXd::Identity(columns, columns) * prior_variance),
          weights_(Eigen::VectorXd::Zero(columns)) {}

    /// Learns a row and returns the innovation.
    double learn(const Eigen::VectorXd& row, double target) {
        const Eigen::VectorXd projected = covariance_ * row;
        const Eigen::VectorXd gain = projected / (factor_ + row.dot(projected));
        const double innovation = target - row.dot(weights_);
        weights_ += gain * innovation;
        covariance_ = (covariance_ - gain * projected.transpose()) / factor_;
        return innovation;
    }

  private:
    double factor_;
    Eigen::MatrixXd covariance_;
    Eigen::VectorXd weights_;
};

// A standstill discards at most one horizon of forgetting: variances grow by at most the factor e. A twin
// whose parameters add p (1-λ) = 6 % to the noise variance then adds 17 %, which is 5 % more standard
// deviation.
TEMPLATE_TEST_CASE("after a long standstill the motion is predicted as if learning had been switched off", "",
                   UdFloat, UdDouble, Parametric, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double lambda : {0.999, 0.9995}) {
        const Restart restart = after_standstill<TestType>(engine, lambda, 0, standing_ticks<TestType>);
        CAPTURE(lambda);
        CHECK(restart.finite);
        CHECK(restart.largest_variance <= variance_bound<TestType>(lambda));
        CHECK(restart.twins_error < 1.2 * torque_noise);
        CHECK(restart.first_error < 1.05);
        CHECK(restart.later_error < 1.05);
    }
}

// Encoder noise looks like motion without torque. Near this position the model learns that, and corrects it
// in the first tenths of a second of motion.
TEMPLATE_TEST_CASE("after a long standstill with encoder noise the motion is predicted nearly as well", "",
                   UdFloat, UdDouble, Parametric, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double lambda : {0.999, 0.9995}) {
        const Restart restart =
            after_standstill<TestType>(engine, lambda, encoder_count, standing_ticks<TestType>);
        CAPTURE(lambda);
        CHECK(restart.finite);
        CHECK(restart.largest_variance <= variance_bound<TestType>(lambda));
        CHECK(restart.twins_error < 1.2 * torque_noise);
        CHECK(restart.first_error < 1.3);
        CHECK(restart.later_error < 1.1);
    }
}

TEST_CASE("textbook forgetting fails after the same standstill even in double") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = filtered_constants<UdDouble>(engine, 0.999);
    Estimator<UdDouble> columns(constants); // receives no outputs and only computes the rows
    TextbookForgetting textbook(UdDouble::columns, 1000, 0.999);
    StoppingArm arm(engine);
    const auto learn = [&](UdDouble::Sample sample) {
        const double target = (sample.output[0] - constants.output_offset[0]) / constants.output_noise_std[0];
        sample.output_valid = false;
        const bool predicted = columns.tick(sample, Budget::predict_only()).status.predicted();
        const Eigen::Map<const Eigen::VectorXd> row(columns.regression().columns(), UdDouble::columns);
        return predicted ? textbook.learn(row, target) * constants.output_noise_std[0] : 0;
    };
    double squares_before = 0;
    for (int t = 0; t < 5000; ++t) {
        const double innovation = learn(arm.moving<UdDouble>());
        squares_before += t < 4000 ? 0 : innovation * innovation;
    }
    CHECK(std::sqrt(squares_before / 1000) < 1.2 * torque_noise);
    for (int t = 0; t < (slow_build ? 40'000 : 100'000); ++t) {
        learn(arm.standing<UdDouble>());
    }
    double largest = 0;
    for (int t = 1; t <= stop_ticks; ++t) {
        const double innovation = std::abs(learn(arm.starting<UdDouble>(t)));
        largest = innovation <= largest ? largest : innovation; // also if the innovation is NaN
    }
    CHECK_FALSE(largest < 100 * torque_noise);
}

} // namespace standstill_test
