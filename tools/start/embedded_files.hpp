// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace dfdyn::tools {

/// A file of the project that the program contains.
struct EmbeddedFile {
    std::string_view path; ///< `include/dfdyn/dfdyn.hpp`, `cortex_m/image.ld`, `templates/main.cpp.in`, …
    std::string_view content;
};

std::span<const EmbeddedFile> embedded_files();

} // namespace dfdyn::tools
