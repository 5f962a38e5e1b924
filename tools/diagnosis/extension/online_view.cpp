// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/online_view.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/text/error.hpp"
#include "tools/diagnosis/extension/extended_model.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay.hpp"
#include "tools/training/model_training.hpp"
#include "tools/training/sign_velocity.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

/// bounds the run time of learners that need a tenth of a millisecond per tick
constexpr std::size_t most_rows = 40000;

OnlineError error_of(std::string learner, const TrainedModel& model, const Recording& recording,
                     bool from_prior = false) {
    Progress progress("as an online learner sees it", recording.row_count());
    const auto estimator = make_estimator(model, from_prior);
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

/// Fits hyperparameters with few evaluations, because the table only compares learners.
ModelTraining quick_training(const Structure& structure) {
    ModelTraining training;
    training.options.model = &structure;
    training.options.input = InputKind::DFR;
    training.options.feature_count = 100;
    training.options.likelihood_rows = 300;
    training.options.starts = 1;
    training.options.evaluations_per_start = 60;
    training.options.refinement_evaluations = 0;
    return training;
}

/// Returns the effects for which a training can add columns without a search, one per joint.
std::vector<std::string> trainable_names(const ModelExtension& extension) {
    std::vector<std::string> names;
    for (const ExtensionColumn& column : extension.columns) {
        const std::string& name = column.effect.name;
        if (!effect_kind(name).needs_diagnosis() && std::ranges::find(names, name) == names.end()) {
            names.push_back(name);
        }
    }
    return names;
}

RobotPhysics physics_of(const DiagnosisWork& work, std::vector<std::string> names) {
    RobotPhysics physics{work.signals->robot, std::move(names), usual_sign_velocity, {}};
    if (work.signals->kind == OutputKind::motor_current) {
        physics.torque_constants = to_vector(Eigen::VectorXd(work.torque_gains.cwiseInverse()));
    }
    return physics;
}

OnlineError trained_error(std::string learner, const ModelTraining& training, OutputKind outputs,
                          std::span<const Recording> recordings, const Recording& joined) {
    TrainedModel model = train_model(prepare_training(recordings, training), outputs, training, {}).model;
    calibrate_innovation_limit(model, recordings);
    return error_of(std::move(learner), model, joined, true);
}

void add_feature_learners(OnlineView& view, const DiagnosisWork& work, const ModelExtension& extension,
                          std::span<const Recording> recordings, const Recording& joined) {
    const OutputKind outputs = work.signals->kind;
    const auto add = [&](std::string learner, const ModelTraining& training) {
        view.learners.push_back(trained_error(std::move(learner), training, outputs, recordings, joined));
    };
    add("NP: random features alone", quick_training(structures::NP));
    ModelTraining kernel = quick_training(structures::SPK);
    kernel.physics = physics_of(work, {});
    add("SPK: the rigid body and random features", kernel);
    std::vector<std::string> names = trainable_names(extension);
    if (!names.empty()) {
        kernel.physics = physics_of(work, std::move(names));
        add("SPK with the named effects", kernel);
    }
}

} // namespace

OnlineView online_view(const DiagnosisWork& work, const ModelExtension& extension,
                       const TrainedModel& written, std::span<const Recording> recordings) {
    const Recording joined = joined_recording(recordings);
    OnlineView view;
    const TrainedModel nominal = extended_model(nominal_extension(work), recordings);
    view.learners.push_back(error_of("P: the rigid body alone", nominal, joined));
    if (!extension.columns.empty()) {
        const TrainedModel names = extended_model(names_only(work, extension), recordings);
        view.learners.push_back(error_of("P with the named effects, which start at zero", names, joined));
    }
    view.learners.push_back(
        error_of("the extended model, which starts at the values found", written, joined));
    if (joined.row_count() > most_rows) {
        view.left_out = "the recording has more than 40,000 rows";
        return view;
    }
    try {
        add_feature_learners(view, work, extension, recordings, joined);
    } catch (const InputError& error) {
        view.left_out = error.what();
    }
    return view;
}

} // namespace dfdyn::tools
