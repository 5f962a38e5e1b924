// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/diagnose_recordings.hpp"

#include "tools/base/system/progress.hpp"
#include "tools/base/text/error.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/recordings/name_from_recordings.hpp"

#include <string>

namespace dfdyn::tools {

DiagnosisWork diagnose_recordings(const Robot& robot, std::vector<Recording>& recordings,
                                  DiagnosisOptions options, bool loads_differ) {
    Progress progress("searching for causes, round", 0);
    std::size_t rounds = 0;
    options.progress = [&](int) { progress.update(++rounds); };
    options.parts = recordings;
    if (options.check_setup && recordings.size() > 1) {
        options.setup = suspicions_of_setup(robot, recordings.front(), options); // of all parts
        if (any_refusal(*options.setup)) {
            return diagnose(robot, joined_recording(recordings), options); // states the reasons
        }
    }
    const SeveralRecordings several = fit_recordings(robot, recordings, options, loads_differ);
    if (loads_differ && !several.fitted()) {
        throw InputError("--changed payload: expected at least two recordings of two seconds without a "
                         "gap, found " +
                         std::to_string(several.pooled.size()));
    }
    options.torque_gains = several.torque_gains;
    if (loads_differ && !several.answer.loads.empty()) {
        take_loads_off(recordings, robot, several, options.outputs);
        options.setup.reset(); // it was that of other outputs
    }
    DiagnosisWork work = diagnose(robot, joined_recording(recordings), options);
    name_from_recordings(work, robot, several, recordings);
    return work;
}

} // namespace dfdyn::tools
