// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/bag.hpp"

#include "tools/base/bag/byte_reader.hpp"
#include "tools/base/bag/chunk.hpp"
#include "tools/base/system/byte_source.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <zlib.h>

namespace dfdyn::tools {

namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t magic_size = 8;
constexpr std::size_t record_head_size = 9; ///< operation code and length

/// Operation codes of records (https://mcap.dev/spec).
enum Operation : std::uint8_t {
    schema_record = 0x03,
    channel_record = 0x04,
    message_record = 0x05,
    chunk_record = 0x06,
    data_end_record = 0x0f,
};

/// Reads the records of an MCAP file from front to back; the index at its end is not needed.
class McapReader {
  public:
    McapReader(const std::filesystem::path& path, const BagVisitor& visit)
        : name_(shown(path)), source_(path), visit_(visit) {}

    void read() {
        read_bytes(magic_size);
        for (;;) {
            const std::uint64_t place = place_;
            const Bytes head = read_bytes(record_head_size);
            ByteReader reader(head, at(place));
            const auto operation = reader.number<std::uint8_t>();
            const Bytes content = read_bytes(reader.number<std::uint64_t>());
            if (operation == data_end_record) {
                return;
            }
            read_record(operation, content, at(place));
        }
    }

  private:
    struct Channel {
        BagTopic topic;
        std::string encoding;
    };

    std::string at(std::uint64_t place) const { return name_ + ": record at byte " + std::to_string(place); }

    /// Reads in pieces, so that a damaged length does not allocate more than the file has.
    Bytes read_bytes(std::uint64_t count) {
        constexpr std::uint64_t piece = std::uint64_t{1} << 20U;
        Bytes bytes;
        while (bytes.size() < count) {
            const std::size_t filled = bytes.size();
            bytes.resize(filled + static_cast<std::size_t>(std::min(piece, count - filled)));
            const std::size_t got =
                source_.read({reinterpret_cast<char*>(bytes.data()) + filled, bytes.size() - filled});
            bytes.resize(filled + got);
            if (got == 0) {
                throw InputError(name_ + ": at byte " + std::to_string(place_) + ": expected " +
                                 std::to_string(count) + " more bytes of a complete MCAP file, found " +
                                 std::to_string(filled));
            }
        }
        place_ += count;
        return bytes;
    }

    void read_record(std::uint8_t operation, std::span<const std::byte> content, const std::string& what) {
        ByteReader reader(content, what);
        switch (operation) {
        case schema_record: {
            const auto id = reader.number<std::uint16_t>();
            schemas_[id] = reader.text();
            return;
        }
        case channel_record: {
            const auto id = reader.number<std::uint16_t>();
            const auto schema = reader.number<std::uint16_t>();
            const std::string topic(reader.text());
            channels_[id] = {{topic, schemas_[schema]}, std::string(reader.text())};
            return;
        }
        case message_record:
            read_message(reader);
            return;
        case chunk_record:
            read_chunk(reader, what);
            return;
        default:
            return; // indices, attachments, statistics
        }
    }

    void read_message(ByteReader& reader) {
        const auto id = reader.number<std::uint16_t>();
        reader.number<std::uint32_t>(); // sequence
        const auto log_time = reader.number<std::uint64_t>();
        reader.number<std::uint64_t>(); // publish time
        const auto channel = channels_.find(id);
        if (channel == channels_.end()) {
            throw reader.error("a channel that is declared before its messages",
                               "channel " + std::to_string(id));
        }
        if (channel->second.encoding == "cdr") {
            visit_({channel->second.topic, static_cast<std::int64_t>(log_time), reader.take(reader.left())});
        }
    }

    void read_chunk(ByteReader& reader, const std::string& what) {
        reader.number<std::uint64_t>(); // first and last time
        reader.number<std::uint64_t>();
        const auto size = reader.number<std::uint64_t>();
        const auto checksum = reader.number<std::uint32_t>();
        const std::string compression(reader.text());
        const auto compressed = reader.take(reader.number<std::uint64_t>());
        const Bytes content = decompressed_chunk(compressed, compression, size, what);
        const auto found = static_cast<std::uint32_t>(
            ::crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
        if (checksum != 0 && checksum != found) {
            throw InputError(what + ": expected a chunk with checksum " + std::to_string(checksum) +
                             ", found " + std::to_string(found));
        }
        ByteReader records(content, what + ", chunk");
        while (records.left() > 0) {
            const auto operation = records.number<std::uint8_t>();
            const auto record = records.take(records.number<std::uint64_t>());
            if (operation == chunk_record) {
                throw records.error("a record other than a chunk", "a chunk within a chunk");
            }
            read_record(operation, record, what + ", chunk");
        }
    }

    std::string name_;
    ByteSource source_;
    const BagVisitor& visit_;
    std::uint64_t place_ = 0;
    std::map<std::uint16_t, std::string> schemas_; ///< names of types
    std::map<std::uint16_t, Channel> channels_;
};

} // namespace

void visit_mcap(const std::filesystem::path& path, const BagVisitor& visit) {
    McapReader(path, visit).read();
}

} // namespace dfdyn::tools
