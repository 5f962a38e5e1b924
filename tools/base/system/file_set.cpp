// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_set.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/system/file_place.hpp"
#include "tools/base/system/remove_on_signal.hpp"
#include "tools/base/text/text.hpp"

#include <cerrno>
#include <csignal>
#include <deque>
#include <ostream>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace dfdyn::tools {

namespace fs = std::filesystem;

/// Used by FileSet only.
namespace file_set {

/// Delays the signals that end the program.
class SignalsHeld {
  public:
    SignalsHeld() {
        sigset_t held;
        sigemptyset(&held);
        for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
            sigaddset(&held, signal_number);
        }
        ::pthread_sigmask(SIG_BLOCK, &held, &before_);
    }
    ~SignalsHeld() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsHeld(const SignalsHeld&) = delete;
    SignalsHeld& operator=(const SignalsHeld&) = delete;

  private:
    sigset_t before_{};
};

/// Returns the path of `place` in `folder`; empty unless it is in there.
fs::path path_within(const fs::path& place, const fs::path& folder) {
    const fs::path relative = place.lexically_relative(folder);
    return relative.empty() || *relative.begin() == ".." ? fs::path{} : relative;
}

/// A folder that does not exist yet, under a temporary name.
class NewFolder {
  public:
    /// `target`: absolute; its parent exists. `shown_as`: as named by the user.
    NewFolder(fs::path target, fs::path shown_as)
        : target_(std::move(target)), shown_target_(std::move(shown_as)) {
        for (int attempt = 0, made = -1; made != 0; ++attempt) { // skips names that remain from aborted runs
            temporary_ =
                target_.string() + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(attempt);
            guards_.emplace_back(temporary_.string()); // before it exists, so that a signal always removes it
            made = ::mkdir(temporary_.c_str(), 0777);
            if (made != 0) {
                guards_.pop_back();
                require(errno == EEXIST);
            }
        }
    }

    ~NewFolder() {
        std::error_code ignored;
        fs::remove_all(temporary_, ignored);
    }

    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;

    const fs::path& target() const noexcept { return target_; }

    void make(const fs::path& folder) {
        fs::path place = temporary_;
        for (const fs::path& part : folder) {
            place /= part;
            std::error_code ignored;
            if (!fs::is_directory(place, ignored)) {
                guards_.emplace_back(place.string());
                require(::mkdir(place.c_str(), 0777) == 0);
            }
        }
    }

    /// Returns the temporary place of the file `relative`.
    fs::path place_of(const fs::path& relative) {
        fs::path place = temporary_ / relative;
        guards_.emplace_back(place.string());
        return place;
    }

    void publish() {
        require(::rename(temporary_.c_str(), target_.c_str()) == 0);
        published_ = true;
    }

    void undo() noexcept {
        if (published_) {
            ::rename(target_.c_str(), temporary_.c_str());
        }
    }

  private:
    void require(bool done) const {
        if (!done) {
            throw system_error(shown_target_, "cannot make the folder", errno);
        }
    }

    fs::path target_;
    fs::path shown_target_;
    fs::path temporary_;
    bool published_ = false;
    std::deque<RemoveOnSignal> guards_;
};

} // namespace file_set

class FileSet::Implementation {
  public:
    void add_folder(const fs::path& folder) {
        const fs::path place = place_in_file_system(folder);
        if (file_set::NewFolder* const around = new_folder_around(place)) {
            around->make(file_set::path_within(place, around->target()));
            return;
        }
        fs::path missing = place;
        std::error_code ignored;
        while (missing.has_relative_path() && !fs::exists(missing.parent_path(), ignored)) {
            missing = missing.parent_path();
        }
        if (fs::exists(missing, ignored)) {
            make_folder(folder); // throws if it is a file
            return;
        }
        folders_.emplace_back(missing, folder).make(file_set::path_within(place, missing));
    }

    /// Keeps the content of a pipe or device until the other files are complete, and opens it only then: to
    /// open a named pipe is to wait for its reader, which may be busy with an earlier one.
    void add(const fs::path& target, std::string_view content) {
        std::error_code ignored;
        if (fs::is_other(target, ignored)) {
            check_writable(target);
            const fs::path place = place_in_file_system(target);
            forget(place);
            files_.push_back({place, false, nullptr, target, std::string(content)});
            return;
        }
        Entry& entry = add(target);
        write(*entry.file, content);
        entry.file->finish(); // a set may have more files than a process may hold open
    }

    std::ostream& stream(const fs::path& target) { return add(target).file->stream(); }

    void remove(const fs::path& target) { removed_.push_back(target); }

    void commit() {
        for (const bool direct : {false, true}) {
            for (Entry& entry : files_) {
                if ((entry.file == nullptr || entry.file->is_direct()) == direct) {
                    complete(entry);
                }
            }
        }
        const file_set::SignalsHeld held;
        try {
            publish();
        } catch (...) {
            undo();
            throw;
        }
        keep();
    }

  private:
    struct Entry {
        fs::path place;
        bool in_new_folder;
        std::unique_ptr<AtomicFile> file; ///< null until `commit` for a pipe or device with its content here
        fs::path target;
        std::string late; ///< written when all ordinary files are complete
    };

    static void complete(Entry& entry) {
        if (entry.file == nullptr) {
            entry.file = std::make_unique<AtomicFile>(entry.target);
            write(*entry.file, entry.late);
        }
        entry.in_new_folder ? entry.file->commit() : entry.file->finish();
    }

    static void write(AtomicFile& file, std::string_view content) {
        file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
    }

    void forget(const fs::path& place) {
        std::erase_if(files_, [&](const Entry& entry) { return entry.place == place; });
    }

    Entry& add(const fs::path& target) {
        const fs::path place = place_in_file_system(target);
        forget(place);
        file_set::NewFolder* const around = new_folder_around(place);
        const fs::path written =
            around == nullptr ? target : around->place_of(file_set::path_within(place, around->target()));
        files_.push_back(
            {place, around != nullptr, std::make_unique<AtomicFile>(written, target), target, {}});
        return files_.back();
    }

    file_set::NewFolder* new_folder_around(const fs::path& place) {
        for (file_set::NewFolder& folder : folders_) {
            if (!file_set::path_within(place, folder.target()).empty()) {
                return &folder;
            }
        }
        return nullptr;
    }

    void publish() {
        for (const Entry& entry : files_) {
            if (!entry.in_new_folder) {
                entry.file->publish();
            }
        }
        for (file_set::NewFolder& folder : folders_) {
            folder.publish();
        }
    }

    void undo() noexcept {
        for (file_set::NewFolder& folder : folders_) {
            folder.undo();
        }
        for (const Entry& entry : files_) {
            entry.file->undo();
        }
    }

    void keep() noexcept {
        for (const Entry& entry : files_) {
            entry.file->keep();
        }
        std::error_code ignored;
        for (const fs::path& target : removed_) {
            if (!fs::is_directory(target, ignored)) {
                fs::remove(target, ignored);
            }
        }
    }

    std::deque<file_set::NewFolder> folders_;
    std::vector<Entry> files_; ///< destroyed first: their temporary files are in the folders
    std::vector<fs::path> removed_;
};

FileSet::FileSet() : implementation_(std::make_unique<Implementation>()) {}

FileSet::~FileSet() = default;

void FileSet::add_folder(const fs::path& folder) { implementation_->add_folder(folder); }

std::ostream& FileSet::add(const fs::path& target) { return implementation_->stream(target); }

void FileSet::add(const fs::path& target, std::string_view content) { implementation_->add(target, content); }

void FileSet::remove(const fs::path& target) { implementation_->remove(target); }

void FileSet::commit() { implementation_->commit(); }

} // namespace dfdyn::tools
