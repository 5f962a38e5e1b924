// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

namespace dfdyn::tools {

namespace {

constexpr double longest_s = 1e6;
constexpr int most_postures = 10000;

double required(const ScenarioReader& reader, const std::string& name, double low, double high) {
    return reader.json().number_within(name, low, high);
}

MultisineTask read_multisine(const ScenarioReader& reader) {
    reader.allow_only({"kind", "centre_rad", "amplitude_rad", "lowest_hz", "highest_hz", "tones", "start_s"});
    MultisineTask task;
    task.centre = reader.per_joint("centre_rad");
    task.amplitude = reader.per_joint("amplitude_rad");
    task.lowest_hz = required(reader, "lowest_hz", 1e-4, 1e3);
    task.highest_hz = required(reader, "highest_hz", task.lowest_hz, 1e3);
    task.tones = reader.json().whole_number("tones", 1, 1000);
    task.start_s = reader.within("start_s", 1e-3, longest_s, task.start_s);
    return task;
}

TonesTask read_tones(const ScenarioReader& reader) {
    reader.allow_only({"kind", "centre_rad", "joints", "start_s"});
    TonesTask task;
    task.centre = reader.per_joint("centre_rad");
    for (const JsonReader& joint :
         reader.json().objects("joints", reader.joint_count(), reader.joint_count())) {
        std::vector<Tone>& tones = task.tones.emplace_back();
        for (const JsonReader& entry : joint.objects("tones", 0, 1000)) {
            const ScenarioReader tone(entry, 0);
            tone.allow_only({"hz", "amplitude_rad", "phase_rad"});
            tones.push_back({required(tone, "hz", 1e-4, 1e3), entry.number("amplitude_rad"),
                             tone.within("phase_rad", -100, 100, 0)});
        }
    }
    task.start_s = reader.within("start_s", 1e-3, longest_s, task.start_s);
    return task;
}

PointToPointTask read_point_to_point(const ScenarioReader& reader) {
    reader.allow_only({"kind", "postures", "move_s", "dwell_s"});
    PointToPointTask task;
    for (const JsonReader& posture : reader.json().objects("postures", 1, most_postures)) {
        const ScenarioReader one(posture, reader.joint_count());
        one.allow_only({"position_rad"});
        task.postures.push_back(one.per_joint("position_rad"));
    }
    task.move_s = required(reader, "move_s", 1e-3, longest_s);
    task.dwell_s = reader.within("dwell_s", 0, longest_s, 0);
    return task;
}

void read_plane(const JsonReader& reader, CircleTask& task) {
    const std::string plane = reader.text("plane");
    constexpr std::string_view axes = "xyz";
    if (plane.size() == 2 && plane[0] != plane[1]) {
        const std::size_t first = axes.find(plane[0]);
        const std::size_t second = axes.find(plane[1]);
        if (first != std::string_view::npos && second != std::string_view::npos) {
            task.first_axis = static_cast<int>(first);
            task.second_axis = static_cast<int>(second);
            return;
        }
    }
    throw reader.error("plane", "two different letters of x, y, z", in_quotes(plane));
}

CircleTask read_circle(const ScenarioReader& reader) {
    reader.allow_only({"kind", "centre_m", "radius_m", "plane", "period_s", "start_s", "rest_posture_rad",
                       "rest_pull_per_s", "speed_variation", "centre_variation_m", "posture_variation_rad",
                       "variation_time_s"});
    CircleTask task;
    task.centre = reader.three("centre_m");
    task.radius = required(reader, "radius_m", 1e-6, 1e3);
    read_plane(reader.json(), task);
    task.period_s = required(reader, "period_s", 1e-3, longest_s);
    task.start_s = reader.within("start_s", 1e-3, longest_s, task.start_s);
    task.rest_posture = reader.per_joint("rest_posture_rad");
    task.rest_pull = reader.within("rest_pull_per_s", 0, 100, task.rest_pull);
    task.speed_variation = reader.within("speed_variation", 0, 0.5, 0);
    task.centre_variation = reader.within("centre_variation_m", 0, 1, 0);
    task.posture_variation = reader.within("posture_variation_rad", 0, 3, 0);
    task.variation_time_s = reader.within("variation_time_s", 0.05, longest_s, task.variation_time_s);
    return task;
}

} // namespace

TaskModel read_task(const ScenarioReader& reader) {
    const std::string kind = reader.json().text("kind");
    if (kind == "multisine") {
        return read_multisine(reader);
    }
    if (kind == "tones") {
        return read_tones(reader);
    }
    if (kind == "point_to_point") {
        return read_point_to_point(reader);
    }
    if (kind == "circle") {
        return read_circle(reader);
    }
    throw reader.json().error("kind", "multisine, tones, point_to_point or circle", in_quotes(kind));
}

} // namespace dfdyn::tools
