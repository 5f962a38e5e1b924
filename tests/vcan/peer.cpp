// SPDX-License-Identifier: Apache-2.0
#include "tests/vcan/peer.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace dfdyn::tests {
namespace {

bool has_ended(pid_t pid) {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == pid;
}

} // namespace

bool virtual_time() { return std::getenv("DFDYN_VIRTUAL_TIME") != nullptr; }

bool own_machine() { return std::getenv("DFDYN_VCAN_OWN_MACHINE") != nullptr; }

bool keeps_time() { return virtual_time() || !own_machine(); }

long receivers() {
    std::ifstream lists("/proc/net/can/rcvlist_all");
    const std::string text{std::istreambuf_iterator<char>(lists), {}};
    long count = 0;
    for (std::size_t at = text.find("raw"); at != std::string::npos; at = text.find("raw", at + 1)) {
        ++count;
    }
    return count;
}

bool wait_for_receivers(long more_than) {
    return wait_for([more_than] { return receivers() > more_than; });
}

std::string run(const std::string& command) {
    std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr) {
        throw std::runtime_error("cannot run " + command);
    }
    std::string output;
    std::array<char, 4096> chunk{};
    while (const std::size_t size = std::fread(chunk.data(), 1, chunk.size(), pipe)) {
        output.append(chunk.data(), size);
    }
    if (::pclose(pipe) != 0) {
        throw std::runtime_error(command + ": " + output);
    }
    return output;
}

double number_after(const std::string& text, const std::string& words, const std::string& begin) {
    const std::size_t place = text.find(words, text.find(begin));
    if (place == std::string::npos) {
        throw std::runtime_error("'" + words + "' is not in: " + text);
    }
    return std::stod(text.substr(place + words.size()));
}

Background::Background(const std::string& command, Ready ready) {
    const long receivers_before = receivers();
    const std::string to_file = "exec " + command + " >" + (directory_.path() / "output").string() + " 2>&1";
    pid_ = ::fork();
    if (pid_ == 0) {
        ::execl("/bin/sh", "sh", "-c", to_file.c_str(), static_cast<char*>(nullptr));
        ::_exit(127);
    }
    const auto is_ready = [&] {
        return ready == Ready::at_once || receivers() > receivers_before || has_ended(pid_);
    };
    if (pid_ < 0 || !wait_for(is_ready)) {
        throw std::runtime_error("does not start: " + command);
    }
}

Background::~Background() {
    ::kill(pid_, SIGCONT);
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
}

void Background::signal(int number) const { ::kill(pid_, number); }

std::string Background::output(std::size_t lines) const {
    const auto read = [&] { return file_content(directory_.path() / "output"); };
    wait_for([&] { return static_cast<std::size_t>(std::ranges::count(read(), '\n')) >= lines; });
    return read();
}

RawSocket::RawSocket(const std::string& interface) : descriptor_(::socket(AF_CAN, SOCK_RAW, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
        throw std::runtime_error("cannot bind to " + interface);
    }
}

RawSocket::~RawSocket() { ::close(descriptor_); }

bool RawSocket::send(std::uint32_t can_id, const std::array<std::uint8_t, 8>& data) const {
    can_frame frame{};
    frame.can_id = can_id;
    frame.can_dlc = CAN_MAX_DLEN;
    std::ranges::copy(data, frame.data);
    return ::write(descriptor_, &frame, sizeof(frame)) == sizeof(frame);
}

std::vector<hal::Frame> receive(hal::SocketCanBus& bus, std::size_t count) {
    std::vector<hal::Frame> frames;
    std::array<hal::Frame, 32> room{};
    wait_for([&] {
        const auto got = bus.drain(room);
        frames.insert(frames.end(), got.begin(), got.end());
        return frames.size() >= count;
    });
    return frames;
}

void empty(hal::SocketCanBus& bus) {
    std::array<hal::Frame, 32> room{};
    while (!bus.drain(room).empty()) {
    }
}

hal::SocketCanOptions on_vcan0() { return {.interface = "vcan0"}; }

} // namespace dfdyn::tests
