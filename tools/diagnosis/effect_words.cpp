// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/effect_words.hpp"

#include <map>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

struct Words {
    const char* signature;
    const char* confirm;
};

const Words& words_of(const std::string& effect) {
    static const std::map<std::string, Words> words{
        {"viscous_friction",
         {"grows in proportion to the joint's velocity",
          "move this joint alone at five constant speeds in both directions: the torque's mean rises "
          "linearly with speed"}},
        {"coulomb_friction",
         {"keeps its size and changes sign with the direction of motion",
          "move this joint alone slowly at constant speed in both directions: the torques differ by twice "
          "this value"}},
        {"stribeck_friction",
         {"changes sign with the direction of motion and is largest at the lowest speeds",
          "move this joint alone at constant speeds from very slow to medium: the torque first falls with "
          "speed"}},
        {"load_dependent_friction",
         {"changes sign with the direction of motion, with a size in proportion to the joint's load",
          "repeat one slow motion of this joint with and without a known payload: the friction grows with "
          "the load"}},
        {"presliding_hysteresis",
         {"builds up over a stretch of travel after each reversal",
          "move this joint back and forth with amplitudes below and above the stretch: torque over position "
          "draws a loop"}},
        {"torque_offset",
         {"is constant",
          "hold the arm still in postures where this joint carries no load and read the torque"}},
        {"rotor_inertia",
         {"is in proportion to the joint's own acceleration, whatever the posture",
          "swing this joint alone with growing frequency in two postures: the extra inertia is the same in "
          "both"}},
        {"joint_spring",
         {"is in proportion to the joint's position",
          "hold this joint at several angles with its axis vertical, where gravity plays no part"}},
        {"torque_ripple",
         {"repeats with the joint's angle",
          "turn this joint slowly through a full turn in both directions and count the waves"}},
        {"backlash",
         {"looks like a position that jumps when the joint's load changes sign",
          "load this joint by hand to both sides with its motor held, and measure the play at the link"}},
        {"joint_flexibility",
         {"looks like a position that yields in proportion to the joint's load",
          "hold the motor, hang known weights on the link, and measure how far the link gives way"}},
        {"actuator_gain",
         {"is in proportion to the joint's whole torque",
          "hold a known weight at a known distance and compare the torque with the product"}},
        {"payload",
         {"is that of a mass fixed to the tool",
          "take everything off the tool and record the same motion again"}},
        {"link_inertia_error",
         {"is that of a mass, or a centre of mass, that differs from the model's",
          "hold the arm still in a dozen postures that turn this link about its own axes; weigh the link if "
          "it comes off"}},
        {"gravity_tilt",
         {"is that of a gravity that points elsewhere",
          "put a level on the base; or repeat a static pose after turning the first joint by half a turn"}},
        {"ft_bias",
         {"is constant in the sensor's own frame",
          "hold the sensor still in six orientations: the mean of the readings is the bias"}},
        {"ft_drift",
         {"grows with time, whatever the motion",
          "hold the arm still for ten minutes and watch the reading"}},
        {"ft_gain",
         {"is in proportion to the same axis of the wrench",
          "hang a known weight along this axis of the sensor"}},
        {"ft_crosstalk",
         {"is in proportion to another axis of the wrench",
          "hang a known weight along the other axis and watch this one"}},
        {"ft_rotation",
         {"is that of a sensor that is mounted turned",
          "hang a known weight on the tool in three orientations of the sensor"}},
        {"encoder_offset",
         {"is that of a position that is off by a constant",
          "move this joint to its mechanical mark and read the encoder"}},
        {"encoder_eccentricity",
         {"is that of a position error with one cycle per turn",
          "compare this encoder with an outside reference over a full turn"}},
        {"delay",
         {"is in proportion to the rate of the output",
          "repeat the motion at half the speed: the error halves, the delay stays"}},
        {"friction_drift",
         {"is the friction's own shape, with a size that changes with time",
          "repeat the same motion cold and after half an hour"}},
        {"external_contact",
         {"is there for a stretch of time only", "repeat the motion with nothing within reach of the arm"}}};
    const auto found = words.find(effect);
    if (found == words.end()) {
        throw std::logic_error("no words for effect " + effect);
    }
    return found->second;
}

} // namespace

std::string effect_signature(const std::string& effect) { return words_of(effect).signature; }

std::string confirming_experiment(const std::string& effect, const std::string& where) {
    return where + ": " + words_of(effect).confirm;
}

} // namespace dfdyn::tools
