// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

namespace dfdyn::tools {

namespace {

LinkError read_link_error(const JsonReader& entry, int joint_count) {
    const ScenarioReader one(entry, joint_count);
    one.allow_only({"link", "delta_mass_kg", "delta_centre_m", "delta_inertia_kgm2"});
    LinkError error;
    error.joint = static_cast<std::size_t>(entry.whole_number("link", 1, joint_count) - 1);
    error.delta_mass = one.within("delta_mass_kg", -1e4, 1e4, 0);
    if (entry.has("delta_centre_m")) {
        error.delta_centre = one.three("delta_centre_m");
    }
    if (entry.has("delta_inertia_kgm2")) {
        error.delta_inertia = one.three("delta_inertia_kgm2");
    }
    return error;
}

Contact read_contact(const JsonReader& entry, int joint_count) {
    const ScenarioReader one(entry, joint_count);
    one.allow_only({"start_s", "end_s", "joint", "peak_nm", "force_n"});
    Contact contact;
    contact.start_s = entry.number_within("start_s", 0, 1e6);
    contact.end_s = entry.number_within("end_s", contact.start_s + 1e-3, 1e6);
    if (entry.has("joint") == entry.has("force_n")) {
        throw entry.error("joint", "either joint and peak_nm, or force_n", "both or none");
    }
    if (entry.has("joint")) {
        contact.joint = entry.whole_number("joint", 1, joint_count) - 1;
        contact.peak = entry.number("peak_nm");
    } else {
        contact.force = one.three("force_n");
    }
    return contact;
}

TorqueRipple read_ripple(const ScenarioReader& reader) {
    reader.allow_only({"amplitude_nm", "cycles_per_turn", "phase_rad"});
    return {reader.per_joint("amplitude_nm"), reader.per_joint("cycles_per_turn"),
            reader.per_joint("phase_rad", 0)};
}

} // namespace

RobotErrors read_robot_errors(const ScenarioReader& reader) {
    RobotErrors errors;
    if (!reader.json().has("arm")) {
        return errors;
    }
    const ScenarioReader arm = reader.object("arm");
    arm.allow_only({"links", "tilt_rad", "springs", "start_offset_rad"});
    if (arm.json().has("links")) {
        for (const JsonReader& entry : arm.json().objects("links", 0, 100)) {
            errors.links.push_back(read_link_error(entry, reader.joint_count()));
        }
    }
    if (arm.json().has("tilt_rad")) {
        const std::vector<double> tilt = arm.json().numbers("tilt_rad", 2);
        errors.tilt_x = tilt[0];
        errors.tilt_y = tilt[1];
    }
    return errors;
}

JointVector read_start_offset(const ScenarioReader& reader) {
    return reader.json().has("arm") ? reader.object("arm").per_joint("start_offset_rad", 0) : JointVector();
}

JointLoads read_joint_loads(const ScenarioReader& reader) {
    JointLoads loads;
    if (reader.json().has("arm") && reader.object("arm").json().has("springs")) {
        const ScenarioReader springs = reader.object("arm").object("springs");
        springs.allow_only({"stiffness_nm_per_rad", "rest_rad"});
        loads.springs = {springs.per_joint("stiffness_nm_per_rad"), springs.per_joint("rest_rad", 0)};
    }
    if (reader.object("actuators").json().has("ripple")) {
        loads.ripple = read_ripple(reader.object("actuators").object("ripple"));
    }
    if (reader.json().has("contacts")) {
        for (const JsonReader& entry : reader.json().objects("contacts", 0, 100)) {
            loads.contacts.push_back(read_contact(entry, reader.joint_count()));
        }
    }
    return loads;
}

std::vector<Payload> read_payloads(const JsonReader& reader) {
    std::vector<Payload> payloads;
    for (const JsonReader& entry : reader.objects("payloads", 0, 100)) {
        const ScenarioReader one(entry, 0);
        one.allow_only({"attached_s", "removed_s", "mass_kg", "centre_m"});
        Payload payload;
        payload.attached_s = one.within("attached_s", 0, 1e6, 0);
        payload.removed_s = one.within("removed_s", payload.attached_s + 1e-3, 1e7, payload.removed_s);
        payload.mass = one.json().number_within("mass_kg", 1e-6, 1e4);
        payload.centre = one.three("centre_m");
        if (!payloads.empty() && payload.attached_s < payloads.back().attached_s) {
            throw one.json().error("attached_s", "payloads in order of time",
                                   number_text(payload.attached_s));
        }
        payloads.push_back(payload);
    }
    return payloads;
}

OutputNoiseModel read_output_noise(const ScenarioReader& reader) {
    reader.allow_only({"torque_nm", "wrench", "coefficient", "series", "piece_rows"});
    OutputNoiseModel model;
    model.torque = reader.per_joint("torque_nm", 0);
    model.wrench = reader.six("wrench");
    model.coefficient = reader.within("coefficient", -0.9999, 0.9999, 0);
    model.piece_rows = static_cast<std::size_t>(
        reader.json().whole_or("piece_rows", static_cast<int>(model.piece_rows), 2, 1'000'000));
    if (reader.json().has("series")) {
        model.series = reader.json().numbers("series");
        if (model.series.size() <= model.piece_rows) {
            throw reader.json().error("series", "more values than piece_rows",
                                      std::to_string(model.series.size()));
        }
    }
    return model;
}

} // namespace dfdyn::tools
