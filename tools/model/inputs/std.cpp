// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/input_description.hpp"

namespace dfdyn::tools {

namespace {

bool three_rows(const InputModel& input) {
    return input.rows_per_joint == 3 &&
           (input.derivatives == Derivatives::measured ? input.lags == 0 : input.lags >= 2);
}

std::string standard_type(const InputModel& input) {
    return input.derivatives == Derivatives::measured ? "StandardMeasured"
                                                      : "Standard<" + std::to_string(input.lags) + ">";
}

} // namespace

const InputDescription& std_input() {
    static const InputDescription description{.kind = InputKind::STD,
                                              .name = "STD",
                                              .form = InputForm::derivatives,
                                              .fits = three_rows,
                                              .firmware_type = standard_type,
                                              .motion = MotionSource::derivatives,
                                              .cross_validation = true};
    return description;
}

} // namespace dfdyn::tools
