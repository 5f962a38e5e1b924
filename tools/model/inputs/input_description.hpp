// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/inputs/row_family.hpp"
#include "tools/model/model.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace dfdyn::tools {

/// The quantities from which an input computes xi. They determine the constants that it stores.
enum class InputForm {
    derivatives, ///< positions, velocities and accelerations; no rows
    window,      ///< the last positions themselves, scaled
    rows,        ///< R times the last positions
};

/// Velocities and accelerations of the physics, in addition to the input, unless the physics has filters of
/// its own.
enum class MotionSource {
    derivatives, ///< from the recording
    own_filters, ///< rows 2 and 3 in physical units
    own_rows,    ///< rows 2 and 3, of length 1, with additional factors
    polynomial,  ///< a polynomial of degree 2 through the window
};

/// Sizes of the rows R.
struct RowShape {
    int lags = 0;                    ///< M
    int rows_per_joint = 0;          ///< k; used by inputs that choose it
    Eigen::MatrixXd pooled_factor{}; ///< see LagSpread; used by inputs with free rows
};

/// Properties of an input (paper, Section V). To add one: a value of InputKind, a file in this folder, a line
/// in input_catalogue.cpp, and its type in the firmware.
struct InputDescription {
    InputKind kind;
    const char* name; ///< on the command line and in model.json
    InputForm form;
    /// Returns whether a stored input has a permitted number of lags and rows per joint.
    bool (*fits)(const InputModel& input);
    /// Returns the firmware's type, without its namespace.
    std::string (*firmware_type)(const InputModel& input);
    /// Returns the rows with their learned parameters; null for the form `derivatives`.
    std::unique_ptr<RowFamily> (*rows)(const RowShape& shape) = nullptr;
    MotionSource motion;
    int least_lags = 1;
    bool weighted = false;                  ///< the firmware's scale includes the weight of each lag
    bool filters = false;                   ///< stores the gains and poles from which its rows are computed
    bool chooses_rows = false;              ///< rows per joint: an option, 1 … M+1
    bool cross_validation = false;          ///< the grid of the paper's cross validation has this input
    std::optional<InputKind> starts_from{}; ///< training starts from the best fit of this input

    bool uses_derivatives() const { return form == InputForm::derivatives; }
};

const InputDescription& std_input();
const InputDescription& df_input();
const InputDescription& dfw_input();
const InputDescription& dfr_input();
const InputDescription& dfsr_input();

/// Returns all inputs, in the order of the paper.
std::span<const InputDescription* const> input_catalogue();

const InputDescription& input_description(InputKind kind);

/// Returns the names, with a separator between them.
std::string input_names(const char* separator);

/// Returns the input with this name. Throws InputError with a list of the names for any other.
InputKind parse_input_kind(const std::string& name);

} // namespace dfdyn::tools
