// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/online_view.hpp"

#include "tools/common/progress.hpp"
#include "tools/diagnosis/extended_model.hpp"
#include "tools/diagnosis/joined_recording.hpp"
#include "tools/evaluation/replay.hpp"

#include <utility>

namespace dfdyn::tools {

namespace {

OnlineError error_of(std::string learner, const TrainedModel& model, const Recording& recording) {
    Progress progress("as an online learner sees it", recording.row_count());
    const auto estimator = make_estimator(model, false);
    const ReplayedRecording replayed =
        replay(*estimator, {&model, 1}, recording, 0, [&](std::size_t done) { progress.update(done); });
    const std::size_t outputs = model.outputs.names.size();
    const std::size_t ticks = replayed.time_s.size();
    const auto count = static_cast<Eigen::Index>(outputs);
    OnlineError error{std::move(learner), Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (std::size_t k = 0; k < outputs; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        error.transient[row] = normalised_error(replayed, outputs, k, 0, ticks / 3);
        error.steady[row] = normalised_error(replayed, outputs, k, ticks / 3, ticks);
    }
    return error;
}

} // namespace

OnlineView online_view(const DiagnosisWork& work, const Extension& extension, const TrainedModel& written,
                       std::span<const Recording> recordings) {
    const Recording joined = joined_recording(recordings);
    OnlineView view;
    const TrainedModel nominal = extended_model(nominal_extension(work), recordings);
    view.learners.push_back(error_of("P: the rigid body alone", nominal, joined));
    if (!extension.columns.empty()) {
        const TrainedModel names = extended_model(names_only(work, extension), recordings);
        view.learners.push_back(error_of("P with the names, their coefficients from zero", names, joined));
    }
    view.learners.push_back(error_of("the extended model, from its own start", written, joined));
    return view;
}

} // namespace dfdyn::tools
