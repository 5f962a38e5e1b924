// SPDX-License-Identifier: Apache-2.0
#include "tools/can/description/dbc.hpp"

#include "tools/base/system/read_file.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/description/text_cursor.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr std::uint32_t extended_bit = 1U << 31U;

class Parser {
  public:
    Parser(std::string_view text, const std::string& source) : cursor_(text, source) {}

    Dbc run() {
        while (!cursor_.at_end()) {
            cursor_.skip_blanks();
            if (cursor_.accept("BO_ ")) {
                message();
            } else if (cursor_.accept("SG_ ")) {
                signal();
            } else if (cursor_.accept("SIG_VALTYPE_ ")) {
                value_type();
            } else if (cursor_.accept("SG_MUL_VAL_ ")) {
                multiplexed_values();
            }
            cursor_.skip_line();
        }
        return std::move(dbc_);
    }

  private:
    /// `BO_ 641 NAME: 8 SENDER`
    void message() {
        DbcMessage message;
        const TextCursor at_id = cursor_.here();
        message.id = static_cast<std::uint32_t>(cursor_.whole("an identifier", 0xFFFFFFFF));
        message.name = cursor_.name("a message's name");
        message.extended = (message.id & extended_bit) != 0;
        message.id &= ~extended_bit;
        // signals without a message, which are not on a bus
        current_ = message.name != "VECTOR__INDEPENDENT_SIG_MSG";
        if (!current_) {
            return;
        }
        if (message.id >= (1U << (message.extended ? 29U : 11U))) {
            at_id.refuse("an identifier of 11 bits, or of 29 with 2147483648 added");
        }
        if (find(message.id, message.extended) != nullptr || dbc_.find(message.name) != nullptr) {
            at_id.refuse("a message with an identifier and a name of its own");
        }
        cursor_.expect(":");
        message.length = static_cast<int>(cursor_.whole("a number of bytes", 64));
        dbc_.messages.push_back(std::move(message));
    }

    /// `SG_ NAME m3 : 7|16@0- (0.1,-40) [-40|200] "unit" RECEIVER`
    void signal() {
        if (!current_) {
            return;
        }
        if (dbc_.messages.empty()) {
            cursor_.refuse("a message before its signals");
        }
        DbcMessage& message = dbc_.messages.back();
        const TextCursor at_name = cursor_.here();
        DbcSignal read;
        read.name = cursor_.name("a signal's name");
        if (message.find(read.name) != nullptr) {
            at_name.refuse("a signal's name that the message does not have yet");
        }
        multiplexing(read);
        cursor_.expect(":");
        layout(message, read.signal);
        scaling(read);
        message.signals.push_back(std::move(read));
    }

    /// Reads `M`, `m3`, or `m3M`, which is multiplexed and a multiplexor of other signals.
    void multiplexing(DbcSignal& read) {
        if (cursor_.accept("m")) {
            read.multiplex = cursor_.whole("a multiplexor's value", 0xFFFFFFFF);
        }
        read.multiplexor = cursor_.accept("M");
    }

    /// `SG_MUL_VAL_ 641 NAME MULTIPLEXOR 0-3, 7-7;` In the list of new symbols (NS_) the keyword has no
    /// arguments.
    void multiplexed_values() {
        cursor_.skip_blanks();
        if (cursor_.at_line_end()) {
            return;
        }
        const auto id = static_cast<std::uint32_t>(cursor_.whole("an identifier", 0xFFFFFFFF));
        const std::string name = cursor_.name("a signal's name");
        const std::string multiplexor = cursor_.name("a multiplexor's name");
        std::vector<DbcValueRange> ranges;
        do {
            DbcValueRange range;
            range.first = cursor_.whole("a multiplexor's value", 0xFFFFFFFF);
            cursor_.expect("-");
            range.last = cursor_.whole("a multiplexor's value", 0xFFFFFFFF);
            ranges.push_back(range);
        } while (cursor_.accept(","));
        DbcMessage* const message = find(id & ~extended_bit, (id & extended_bit) != 0);
        if (DbcSignal* const found = message == nullptr ? nullptr : signal_of(*message, name)) {
            found->multiplexed_by = multiplexor;
            found->multiplex_ranges = std::move(ranges);
        }
    }

    void layout(const DbcMessage& message, hal::Signal& signal) {
        const TextCursor at_layout = cursor_.here();
        signal.start_bit = static_cast<int>(cursor_.whole("a start bit", 511));
        cursor_.expect("|");
        signal.length = static_cast<int>(cursor_.whole("a number of bits", 64));
        cursor_.expect("@");
        signal.byte_order =
            cursor_.whole("a byte order", 1) == 1 ? hal::ByteOrder::intel : hal::ByteOrder::motorola;
        const bool is_signed = cursor_.accept("-");
        if (!is_signed) {
            cursor_.expect("+");
        }
        signal.encoding = is_signed ? hal::Encoding::signed_integer : hal::Encoding::unsigned_integer;
        if (!signal.fits(message.length)) {
            at_layout.refuse("bits within the " + std::to_string(message.length) + " bytes of the message");
        }
    }

    void scaling(DbcSignal& read) {
        cursor_.expect("(");
        const TextCursor at_factor = cursor_.here();
        read.signal.factor = cursor_.number("a factor");
        if (read.signal.factor == 0) {
            at_factor.refuse("a factor that is not 0");
        }
        cursor_.expect(",");
        read.signal.offset = cursor_.number("an offset");
        cursor_.expect(")");
        cursor_.expect("[");
        read.lowest = cursor_.number("a lowest value");
        cursor_.expect("|");
        read.highest = cursor_.number("a highest value");
        cursor_.expect("]");
        read.unit = cursor_.quoted();
    }

    /// `SIG_VALTYPE_ 641 NAME : 1;` 1: float, 2: double, 0: an integer. In the list of new symbols (NS_) the
    /// keyword has no arguments.
    void value_type() {
        cursor_.skip_blanks();
        if (cursor_.at_line_end()) {
            return;
        }
        const TextCursor at_id = cursor_.here();
        const auto id = static_cast<std::uint32_t>(cursor_.whole("an identifier", 0xFFFFFFFF));
        const std::string name = cursor_.name("a signal's name");
        cursor_.accept(":");
        const std::uint64_t type = cursor_.whole("a value type", 2);
        DbcMessage* const message = find(id & ~extended_bit, (id & extended_bit) != 0);
        DbcSignal* const found = message == nullptr ? nullptr : signal_of(*message, name);
        if (found == nullptr) {
            at_id.refuse("a signal of a message above");
        }
        if (type != 0) {
            found->signal.encoding = type == 1 ? hal::Encoding::float32 : hal::Encoding::float64;
        }
        if (!found->signal.fits(message->length)) {
            at_id.refuse("a signal of " + std::to_string(32 * type) + " bits",
                         std::to_string(found->signal.length));
        }
    }

    static DbcSignal* signal_of(DbcMessage& message, const std::string& name) {
        const auto found = std::ranges::find(message.signals, name, &DbcSignal::name);
        return found == message.signals.end() ? nullptr : &*found;
    }

    DbcMessage* find(std::uint32_t id, bool extended) {
        const auto found = std::ranges::find_if(dbc_.messages, [&](const DbcMessage& message) {
            return message.id == id && message.extended == extended;
        });
        return found == dbc_.messages.end() ? nullptr : &*found;
    }

    TextCursor cursor_;
    Dbc dbc_;
    bool current_ = true; ///< signals belong to the last message
};

template <class Items>
auto find_named(const Items& items, std::string_view name) {
    const auto found = std::ranges::find(items, name, &Items::value_type::name);
    return found == items.end() ? nullptr : &*found;
}

} // namespace

const DbcSignal* DbcMessage::find(std::string_view signal) const { return find_named(signals, signal); }

const DbcSignal* DbcMessage::multiplexor_of(const DbcSignal& signal) const {
    if (!signal.multiplexed_by.empty()) {
        const DbcSignal* const named = find(signal.multiplexed_by);
        return named != nullptr && named->multiplexor ? named : nullptr;
    }
    const auto found = std::ranges::find_if(signals, &DbcSignal::multiplexor);
    const bool only_one = std::ranges::count_if(signals, &DbcSignal::multiplexor) == 1;
    return only_one && &*found != &signal ? &*found : nullptr;
}

const DbcMessage* Dbc::find(std::string_view message) const { return find_named(messages, message); }

Dbc parse_dbc(std::string_view text, const std::string& source) { return Parser(text, source).run(); }

Dbc read_dbc(const std::filesystem::path& path) {
    return parse_dbc(read_file(path, "cannot be read as a DBC file"), shown(path));
}

} // namespace dfdyn::tools
