// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/size_options.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/sizing/target.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct FootprintOptions {
    std::filesystem::path model;
    SizeOptions sizes;
    bool json = false;
};

int run(const FootprintOptions& options) {
    const TrainedModel model = read_model(options.model);
    const Target& target = find_target(options.sizes.target);
    const JsonOutput output(options.json);
    output.print(footprint_json(model, target));
    print_footprint(std::cout, model, target);
    const std::string excess = excess_text(needs_of(model), options.sizes.budget());
    if (excess.empty()) {
        return 0;
    }
    std::cerr << "dfdyn: " << shown(options.model) << ": beyond the budget: " << excess << '\n';
    return 1;
}

} // namespace

void add_footprint_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<FootprintOptions>();
    CLI::App* command = app.add_subcommand(
        "footprint", "Prints flash, RAM, stack and instructions per tick of a model on a controller");
    command->add_option("--model", options->model, "The model")->required()->type_name("M.json");
    options->sizes.add_to(*command);
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn footprint --model model.json --target cortex-m7 --flash 512K --ram 256K\n"
        "A model of train --flash, --ram or --tick-operations also shows how much accuracy smaller models "
        "would lose.\n"
        "Exit status: 0 done, 1 beyond the given budget, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
