// SPDX-License-Identifier: Apache-2.0
// The DBC files agree with the decoders, as far as a DBC file can describe a protocol.
#include "every_family.hpp"
#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

using namespace dfdyn::hal;
using namespace dfdyn::tests;

namespace {

struct NamedSignal {
    std::uint32_t id;
    int length; ///< bytes of the message
    Signal signal;
};

/// Parser of the statements that our own files use: messages, signals, float marks.
class DbcFile {
  public:
    explicit DbcFile(const std::string& name) {
        std::ifstream file(std::string(DFDYN_TEST_DATA_DIR) + "/../../hal/dbc/" + name);
        REQUIRE(file);
        std::string line;
        while (std::getline(file, line)) {
            read(line);
        }
        REQUIRE_FALSE(signals_.empty());
    }

    [[nodiscard]] const std::map<std::string, NamedSignal>& signals() const { return signals_; }

    /// Returns the signal's value in the one of these frames that contains it.
    [[nodiscard]] double value(const std::string& name, std::initializer_list<Frame> frames) const {
        const NamedSignal& named = signals_.at(name);
        for (const Frame& frame : frames) {
            if (frame.id == named.id) {
                REQUIRE(frame.length == named.length);
                return named.signal.extract({frame.data.data(), frame.length});
            }
        }
        FAIL("no frame of " << name);
        return 0;
    }

  private:
    void read(const std::string& line) {
        static const std::regex message(R"(BO_ (\d+) \w+: (\d+) \w+)");
        static const std::regex signal(
            R"( SG_ (\w+) (?:M |m\d+ )?: (\d+)\|(\d+)@([01])([+-]) \(([^,]+),([^)]+)\) \[[^\]]*\] "[^"]*" \w+)");
        static const std::regex is_float(R"(SIG_VALTYPE_ (\d+) (\w+) : 1;)");
        std::smatch part;
        if (std::regex_match(line, part, message)) {
            id_ = static_cast<std::uint32_t>(std::stoul(part[1])) & 0x7FFFFFFFU; // bit 31: 29-bit identifier
            length_ = std::stoi(part[2]);
        } else if (std::regex_match(line, part, signal)) {
            signals_[part[1]] = {id_,
                                 length_,
                                 {std::stoi(part[2]), std::stoi(part[3]),
                                  part[4] == "1" ? ByteOrder::intel : ByteOrder::motorola,
                                  part[5] == "+" ? Encoding::unsigned_integer : Encoding::signed_integer,
                                  std::stod(part[6]), std::stod(part[7])}};
        } else if (std::regex_match(line, part, is_float)) {
            signals_.at(part[2]).signal.encoding = Encoding::float32;
        } else {
            REQUIRE_FALSE((line.starts_with("BO_ ") || line.starts_with(" SG_")));
        }
    }

    std::map<std::string, NamedSignal> signals_;
    std::uint32_t id_ = 0;
    int length_ = 0;
};

template <class Values>
Values random_values(std::mt19937_64& engine, double size) {
    Values values{};
    std::uniform_real_distribution<double> uniform(-size, size);
    for (auto& value : values) {
        if constexpr (requires { value.position_rad; }) {
            value.position_rad = uniform(engine);
            value.effort = uniform(engine);
        } else {
            value = uniform(engine);
        }
    }
    return values;
}

/// Checks that decoder and DBC file give the same values for a frame with one joint.
template <class Board>
void check_joint(const char* name, Board board, bool effort, const char* effort_name) {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile dbc(name);
    for (int i = 0; i < 100; ++i) {
        const FrameList sent = board.encode(random_values<std::array<JointValue, 1>>(engine, 3));
        const Frame& last = sent.frame[static_cast<std::size_t>(sent.count - 1)];
        CHECK(dbc.value("q1", {sent.frame[0]}) ==
              Approx(board.decode(sent.frame[0]).joint[0].position_rad).epsilon(1e-12));
        if (effort) {
            CHECK(dbc.value(effort_name, {last}) ==
                  Approx(board.decode(last).joint[0].effort).epsilon(1e-12));
        }
    }
}

constexpr std::array axis_names{"fx", "fy", "fz", "mx", "my", "mz"};

/// DBC files of all families.
template <class... Family>
struct DbcNames {
    static std::set<std::string> get() {
        std::set<std::string> names{Family::dbc...};
        names.erase("");
        return names;
    }
};

} // namespace

TEST_CASE("every signal of the DBC files lies within its message") {
    for (const std::string& name : EveryFamily<DbcNames>::get()) {
        const DbcFile dbc(name);
        for (const auto& [signal, named] : dbc.signals()) {
            INFO(name << " " << signal);
            CHECK(named.signal.fits(named.length));
        }
    }
}

TEST_CASE("the DBC file of the iCub's two-joint boards agrees with the decoder") {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile dbc("icub_two_joint_boards.dbc");
    icub::TwoJointBoard board(2, {2, -11.375, 0}, {3, -11.375, 0});
    for (int i = 0; i < 100; ++i) {
        const Frame frame = board.encode(random_values<std::array<JointValue, 2>>(engine, 3)).frame[0];
        const Decoded decoded = board.decode(frame);
        CHECK(dbc.value("q3", {frame}) == Approx(decoded.joint[0].position_rad).epsilon(1e-12));
        CHECK(dbc.value("q4", {frame}) == Approx(decoded.joint[1].position_rad).epsilon(1e-12));
    }
    using Board = icub::TwoJointBoard;
    const Frame status = board.encode_status(Board::absolute_encoder_error, Board::optical_encoder_error);
    CHECK(dbc.value("absolute_encoder_error3", {status}) == 1);
    CHECK(dbc.value("optical_encoder_error3", {status}) == 0);
    CHECK(dbc.value("absolute_encoder_error4", {status}) == 0);
    CHECK(dbc.value("optical_encoder_error4", {status}) == 1);
}

TEST_CASE("the DBC files of single joints agree with their decoders") {
    const icub::FocBoard foc({.address = 1, .joint = 0});
    check_joint("icub_2foc.dbc", foc, true, "i1");
    CHECK(DbcFile("icub_2foc.dbc").value("encoder_errors1", {foc.encode_status(0x12, 7)}) == 0x12);
    CHECK(DbcFile("icub_2foc.dbc").value("faults1", {foc.encode_status(0x12, 0x80000007)}) == 0x80000007);
    const Cia402Drive drive({.node = 1, .joint = 0, .effort_pdo = 0x380, .effort_length = 2});
    check_joint("cia402.dbc", drive, true, "tau1");
    const DbcFile cia402("cia402.dbc");
    CHECK(cia402.value("state1", {drive.encode_heartbeat(Cia402Drive::State::pre_operational)}) == 127);
    CHECK(cia402.value("error_code1", {drive.encode_emcy(0x8130)}) == 0x8130);
    const OdriveAxis axis({.node = 1, .joint = 0});
    check_joint("odrive.dbc", axis, false, "");
    CHECK(DbcFile("odrive.dbc").value("encoder_error1", {axis.encode_heartbeat(true)}) == 1);
}

TEST_CASE("the DBC files of the motors agree with their decoders") {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile servo("cubemars.dbc");
    const DbcFile rmd("rmd.dbc");
    const DbcFile piper("piper.dbc");
    CubemarsServo servo_motor({.motor_id = 1, .packet = 0x29});
    RmdMotor rmd_motor({.motor_id = 1});
    PiperPair pair(PiperPair::Config{});
    std::uniform_real_distribution<double> uniform(-3, 3);
    for (int i = 0; i < 100; ++i) {
        std::array<JointValue, 2> sent{};
        for (JointValue& value : sent) {
            value.position_rad = uniform(engine);
            value.effort = uniform(engine);
            value.has_velocity = true;
            value.velocity = uniform(engine);
        }
        const Frame feedback = servo_motor.encode({sent[0]}).frame[0];
        const JointValue one = servo_motor.decode(feedback).joint[0];
        CHECK(servo.value("q1", {feedback}) == Approx(one.position_rad).epsilon(1e-12));
        CHECK(servo.value("qd1", {feedback}) == Approx(one.velocity).epsilon(1e-12));
        CHECK(servo.value("i1", {feedback}) == Approx(one.effort).epsilon(1e-12));
        const FrameList answers = rmd_motor.encode({sent[0]});
        CHECK(rmd.value("q1", {answers.frame[0]}) ==
              Approx(rmd_motor.decode(answers.frame[0]).joint[0].position_rad).epsilon(1e-12));
        CHECK(rmd.value("command1", {answers.frame[0]}) == 146);
        CHECK(rmd.value("i1", {answers.frame[1]}) ==
              Approx(rmd_motor.decode(answers.frame[1]).joint[0].effort).epsilon(1e-12));
        const FrameList arm = pair.encode(sent);
        CHECK(piper.value("q2", {arm.frame[0]}) ==
              Approx(pair.decode(arm.frame[0]).joint[1].position_rad).epsilon(1e-12));
        CHECK(piper.value("qd2", {arm.frame[2]}) ==
              Approx(pair.decode(arm.frame[2]).joint[0].velocity).epsilon(1e-12));
        CHECK(piper.value("i1", {arm.frame[1]}) ==
              Approx(pair.decode(arm.frame[1]).joint[0].effort).epsilon(1e-12));
    }
}

TEST_CASE("the DBC file of the strain board agrees with the decoder") {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile dbc("icub_strain.dbc");
    icub::StrainBoard board(13);
    const Wrench full_scale{1500, 1500, 2000, 35, 35, 25};
    for (std::size_t channel = 0; channel < 6; ++channel) {
        const Frame reply = board.encode_full_scale(static_cast<int>(channel), full_scale[channel]);
        CHECK(dbc.value("command", {reply}) == 0x18);
        CHECK(dbc.value("channel", {reply}) == static_cast<double>(channel));
        CHECK(dbc.value("full_scale", {reply}) == full_scale[channel]);
        board.decode(reply);
    }
    for (int i = 0; i < 100; ++i) {
        const FrameList sent = board.encode(random_values<Wrench>(engine, 24));
        const WrenchReading reading = board.wrench(sent.frame[0], sent.frame[1]);
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(dbc.value(axis_names[k], {sent.frame[0], sent.frame[1]}) ==
                  Approx(reading.value[k]).epsilon(1e-12).margin(1e-9));
        }
    }
}

TEST_CASE("the DBC file of the Robotous sensor agrees with the decoder with Tx in two parts") {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile dbc("robotous_rft.dbc");
    const RobotousRft sensor(RobotousRft::Config{});
    for (int i = 0; i < 100; ++i) {
        const FrameList sent = sensor.encode(random_values<Wrench>(engine, 16));
        const std::initializer_list<Frame> frames{sent.frame[0], sent.frame[1]};
        const WrenchReading reading = sensor.wrench(sent.frame[0], sent.frame[1]);
        for (const std::size_t k : {0U, 1U, 2U, 4U, 5U}) {
            CHECK(dbc.value(axis_names[k], frames) == Approx(reading.value[k]).epsilon(1e-12));
        }
        CHECK(dbc.value("mx_high", frames) + dbc.value("mx_low", frames) ==
              Approx(reading.value[3]).epsilon(1e-12).margin(1e-12));
        CHECK(dbc.value("response", frames) == 11);
        CHECK(dbc.value("overload", frames) == 0);
    }
    const FrameList overload = sensor.encode({700, 0, 0, 0, 0, -20});
    CHECK(dbc.value("overload", {overload.frame[1]}) == 0b100001);
}

TEST_CASE("the DBC file of the ATI sensor agrees with the decoder") {
    DFDYN_SEEDED_ENGINE(engine);
    const DbcFile dbc("ati_netcan.dbc");
    AtiNetcan::Config config;
    for (std::size_t i = 0; i < 6; ++i) {
        config.matrix[i][i] = 1;
    }
    config.counts_per_newton = 1000;
    config.counts_per_newton_metre = 1000;
    const AtiNetcan sensor(config);
    for (int i = 0; i < 100; ++i) {
        FrameList sent = sensor.encode(random_values<Wrench>(engine, 30));
        sent.frame[0].data[0] = 0x80;
        const WrenchReading reading = sensor.wrench(sent.frame[0], sent.frame[1]);
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(dbc.value("sg" + std::to_string(k), {sent.frame[0], sent.frame[1]}) == reading.raw[k]);
        }
        CHECK(dbc.value("status", {sent.frame[0]}) == 0x8000);
    }
}
