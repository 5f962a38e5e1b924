// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/machine_lower_bound.hpp"

#include "dfdyn/core/vector.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

namespace dfdyn::tools {

namespace {

template <class Scalar>
class TrianglePass final : public Ticking {
  public:
    explicit TrianglePass(int columns)
        : numbers_(Storage<Scalar, dynamic>::zeros(
              {(columns * (columns + 1) / 2 + at_once - 1) / at_once * at_once})) {}

    void tick() override {
        typename Lanes::Type values[unrolled];
        for (int i = 0; i < numbers_.size(); i += at_once) {
            for (int k = 0; k < unrolled; ++k) {
                Lanes::load(numbers_.data() + i + k * lanes, values[k]);
            }
            for (int k = 0; k < unrolled; ++k) {
                Lanes::store(values[k] + Scalar(1), numbers_.data() + i + k * lanes);
            }
        }
    }

  private:
    static constexpr int lanes = detail::wide<Scalar>;
    static constexpr int unrolled = 4;
    static constexpr int at_once = lanes * unrolled;
    using Lanes = detail::Vector<Scalar, lanes>;

    Storage<Scalar, dynamic> numbers_;
};

} // namespace

double arithmetic_floor_us(int columns, const std::string& scalar, double vectors_per_ns) {
    const int lanes = scalar == "float" ? detail::wide<float> : detail::wide<double>;
    return 1.5 * columns * columns / (vectors_per_ns * lanes) / 1000;
}

std::unique_ptr<Ticking> make_triangle_pass(int columns, const std::string& scalar) {
    if (scalar == "float") {
        return std::make_unique<TrianglePass<float>>(columns);
    }
    return std::make_unique<TrianglePass<double>>(columns);
}

} // namespace dfdyn::tools
