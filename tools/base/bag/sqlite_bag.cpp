// SPDX-License-Identifier: Apache-2.0
#include "tools/base/bag/bag.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <map>
#include <memory>

#ifdef DFDYN_HAVE_SQLITE
#include <sqlite3.h>
#endif

namespace dfdyn::tools {

#ifdef DFDYN_HAVE_SQLITE

namespace {

/// A rosbag2 file, opened for reading only.
class SqliteBag {
  public:
    explicit SqliteBag(const std::filesystem::path& path) : name_(shown(path)) {
        sqlite3* opened = nullptr;
        const int result = ::sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
        database_.reset(opened);
        check(result == SQLITE_OK);
    }

    void visit(const BagVisitor& visit) {
        std::map<std::int64_t, BagTopic> topics;
        for (Query query = start("SELECT id, name, type FROM topics WHERE serialization_format = 'cdr'");
             step(query);) {
            topics[::sqlite3_column_int64(query.get(), 0)] = {text(query, 1), text(query, 2)};
        }
        for (Query query = start("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id");
             step(query);) {
            const auto topic = topics.find(::sqlite3_column_int64(query.get(), 0));
            if (topic == topics.end()) {
                continue; // not in CDR
            }
            const auto* const data = static_cast<const std::byte*>(::sqlite3_column_blob(query.get(), 2));
            const auto size = static_cast<std::size_t>(::sqlite3_column_bytes(query.get(), 2));
            visit(
                {topic->second, ::sqlite3_column_int64(query.get(), 1), {data, data == nullptr ? 0 : size}});
        }
    }

  private:
    struct Close {
        void operator()(sqlite3* database) const { ::sqlite3_close(database); }
        void operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }
    };
    using Query = std::unique_ptr<sqlite3_stmt, Close>;

    void check(bool good) const {
        if (!good) {
            throw InputError(
                name_ + ": expected a rosbag2 file of SQLite, found: " + ::sqlite3_errmsg(database_.get()));
        }
    }

    Query start(const char* text) const {
        sqlite3_stmt* statement = nullptr;
        check(::sqlite3_prepare_v2(database_.get(), text, -1, &statement, nullptr) == SQLITE_OK);
        return Query(statement);
    }

    bool step(const Query& query) const {
        const int result = ::sqlite3_step(query.get());
        check(result == SQLITE_ROW || result == SQLITE_DONE);
        return result == SQLITE_ROW;
    }

    static std::string text(const Query& query, int column) {
        const auto* const characters = ::sqlite3_column_text(query.get(), column);
        return characters == nullptr ? "" : reinterpret_cast<const char*>(characters);
    }

    std::string name_;
    std::unique_ptr<sqlite3, Close> database_;
};

} // namespace

void visit_sqlite_bag(const std::filesystem::path& path, const BagVisitor& visit) {
    SqliteBag(path).visit(visit);
}

#else

void visit_sqlite_bag(const std::filesystem::path& path, const BagVisitor&) {
    throw InputError(shown(path) +
                     ": expected a program built with libsqlite3-dev for bags of SQLite, found one "
                     "without it");
}

#endif

} // namespace dfdyn::tools
