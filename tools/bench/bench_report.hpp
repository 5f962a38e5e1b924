// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/bench.hpp"
#include "tools/report/figure_page.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>

namespace dfdyn::tools {

/// Returns the results as tables, with a chart of time over size.
FigurePage bench_page(const BenchResults& results);

/// Returns the results as numbers, schema `dfdyn.bench/1`.
nlohmann::json bench_json(const BenchResults& results);

/// Writes bench.json, bench.md (the page), and pictures/tick-time.svg into `folder`, which is created.
void write_bench(const std::filesystem::path& folder, const BenchResults& results);

} // namespace dfdyn::tools
