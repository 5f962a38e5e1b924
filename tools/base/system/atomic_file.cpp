// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"

#include "tools/base/system/output_stream.hpp"
#include "tools/base/system/remove_on_signal.hpp"
#include "tools/base/text/text.hpp"

#include <cerrno>
#include <climits>
#include <fcntl.h>
#include <locale>
#include <optional>
#include <ostream>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace dfdyn::tools {

namespace fs = std::filesystem;

namespace {

/// Throws InputError if `name`, a part of `path`, is longer than file systems allow.
void require_valid_name(const fs::path& name, const fs::path& path) {
    if (name.native().size() > NAME_MAX) {
        throw system_error(path, "cannot be used as a folder", ENAMETOOLONG);
    }
}

/// Returns the final target of `path`, following symbolic links.
fs::path link_target(fs::path path) {
    constexpr int most_links = 40; // the kernel's own limit
    std::error_code ignored;
    for (int link = 0; link < most_links && fs::is_symlink(path, ignored); ++link) {
        path = path.parent_path() / fs::read_symlink(path, ignored);
    }
    return path;
}

} // namespace

class AtomicFile::Implementation {
  public:
    Implementation(const fs::path& target, const fs::path& shown_target)
        : shown_target_(shown_target), target_(target), buffer_(shown_target), stream_(&buffer_) {
        refuse_dash(target);
        require_parent(target);
        ignore_file_size_signal();
        struct stat status {};
        const bool exists = ::stat(target.c_str(), &status) == 0;
        if (exists && !S_ISREG(status.st_mode)) {
            open_directly();
        } else {
            open_beside(exists ? std::optional(status.st_mode & 07777U) : std::nullopt);
        }
        buffer_.attach(descriptor_);
        stream_.imbue(std::locale::classic());
        stream_.exceptions(std::ios::badbit);
    }

    ~Implementation() {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
        remove_temporary();
    }

    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    std::ostream& stream() noexcept { return stream_; }

    bool is_direct() const noexcept { return direct_; }

    void finish() {
        if (!stream_) {
            throw InputError(shown(shown_target_) + ": cannot write: an earlier write failed");
        }
        if (descriptor_ < 0) {
            return;
        }
        stream_.flush();
        check(direct_ ? 0 : ::fsync(descriptor_), "cannot write");
        check(::close(std::exchange(descriptor_, -1)), "cannot write");
    }

    void publish() {
        if (!temporary_.empty()) {
            check(::rename(temporary_.c_str(), target_.c_str()), "cannot replace");
            temporary_.clear();
        }
    }

    /// Gives an existing target a second name first, from which `undo` restores it.
    void publish_reversibly() {
        if (direct_) {
            return;
        }
        const std::string backup = target_.string() + ".old." + std::to_string(::getpid());
        ::unlink(backup.c_str()); // of an aborted run
        std::error_code ignored;
        if (fs::is_directory(target_, ignored)) {
            throw system_error(shown_target_, "cannot replace", EISDIR);
        }
        // not every file system has hard links; with `rename` there is a moment without the target
        const bool existing =
            ::link(target_.c_str(), backup.c_str()) == 0 || ::rename(target_.c_str(), backup.c_str()) == 0;
        check(existing || errno == ENOENT ? 0 : -1, "cannot replace");
        backup_ = existing ? backup : "";
        publish();
        published_ = true;
    }

    void undo() noexcept {
        if (!backup_.empty()) {
            ::rename(backup_.c_str(), target_.c_str());
        } else if (published_) {
            ::unlink(target_.c_str());
        }
        keep();
    }

    void keep() noexcept {
        ::unlink(backup_.c_str()); // also after `rename`, which leaves both names of one file
        backup_.clear();
    }

  private:
    void check(int result, std::string_view cannot) const {
        if (result < 0) {
            throw system_error(shown_target_, cannot, errno);
        }
    }

    void open_directly() {
        direct_ = true;
        descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
        check(descriptor_, "cannot write");
    }

    void open_beside(std::optional<mode_t> mode) {
        target_ = link_target(fs::absolute(target_));
        check(mode ? ::faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) : 0, "cannot write");
        create_temporary();
        if (mode && ::fchmod(descriptor_, *mode) != 0) {
            const int reason = errno;
            ::close(descriptor_);
            remove_temporary();
            throw system_error(shown_target_, "cannot create a file beside it", reason);
        }
    }

    /// Skips names that remain from an aborted run.
    void create_temporary() {
        const std::string prefix = target_.string() + ".tmp." + std::to_string(::getpid()) + ".";
        for (int attempt = 0; descriptor_ < 0; ++attempt) {
            temporary_ = prefix + std::to_string(attempt);
            guard_.emplace(temporary_); // before the file exists, so that a signal always removes it
            descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            check(errno == EEXIST ? 0 : descriptor_, "cannot create a file beside it");
        }
    }

    void remove_temporary() {
        if (!temporary_.empty()) {
            ::unlink(temporary_.c_str());
        }
    }

    fs::path shown_target_; ///< as named by the user
    fs::path target_;       ///< file to replace: absolute, links followed, unless it is written directly
    bool direct_ = false;
    std::string temporary_; ///< empty if there is no temporary file
    std::string backup_;    ///< second name of the earlier target, until `undo` or `keep`
    bool published_ = false;
    std::optional<RemoveOnSignal> guard_;
    int descriptor_ = -1;
    DescriptorBuffer buffer_;
    std::ostream stream_;
};

AtomicFile::AtomicFile(const fs::path& target, const fs::path& shown_as)
    : implementation_(std::make_unique<Implementation>(target, shown_as.empty() ? target : shown_as)) {}

AtomicFile::~AtomicFile() = default;

std::ostream& AtomicFile::stream() noexcept { return implementation_->stream(); }

void AtomicFile::commit() {
    implementation_->finish();
    implementation_->publish();
}

bool AtomicFile::is_direct() const noexcept { return implementation_->is_direct(); }

void AtomicFile::finish() { implementation_->finish(); }

void AtomicFile::publish() { implementation_->publish_reversibly(); }

void AtomicFile::undo() noexcept { implementation_->undo(); }

void AtomicFile::keep() noexcept { implementation_->keep(); }

class GrowingFile::Implementation {
  public:
    explicit Implementation(const fs::path& target) : buffer_(target), stream_(&buffer_) {
        refuse_dash(target);
        require_parent(target);
        ignore_file_size_signal();
        descriptor_ = ::open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
        if (descriptor_ < 0) {
            throw system_error(target, "cannot write", errno);
        }
        buffer_.attach(descriptor_);
        stream_.imbue(std::locale::classic());
        stream_.exceptions(std::ios::badbit);
    }

    ~Implementation() {
        try {
            stream_.flush();
        } catch (const std::exception& error) { // callers that need the error call flush before
            static_cast<void>(error);
        }
        ::close(descriptor_);
    }

    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    std::ostream& stream() noexcept { return stream_; }

  private:
    int descriptor_ = -1;
    DescriptorBuffer buffer_;
    std::ostream stream_;
};

GrowingFile::GrowingFile(const fs::path& target)
    : implementation_(std::make_unique<Implementation>(target)) {}

GrowingFile::~GrowingFile() = default;

std::ostream& GrowingFile::stream() noexcept { return implementation_->stream(); }

void check_writable(const fs::path& target) {
    struct stat status {};
    if (::stat(target.c_str(), &status) != 0 || S_ISREG(status.st_mode)) {
        const AtomicFile file(target); // not committed: the temporary file is removed
        return;
    }
    const int reason = S_ISDIR(status.st_mode) ? EISDIR : ::access(target.c_str(), W_OK) == 0 ? 0 : errno;
    if (reason != 0) {
        throw system_error(target, "cannot write", reason);
    }
}

void check_folder(const fs::path& folder) {
    refuse_dash(folder);
    fs::path existing = folder;
    std::error_code reason;
    fs::file_type found = fs::status(existing, reason).type();
    while (found == fs::file_type::not_found) {
        require_valid_name(existing.filename(), folder);
        existing = existing.has_parent_path() ? existing.parent_path() : ".";
        found = fs::status(existing, reason).type();
    }
    if (found == fs::file_type::none) {
        throw system_error(folder, "cannot be used as a folder", reason.value());
    }
    if (found != fs::file_type::directory) {
        throw InputError(shown(folder) + ": expected a folder, found the file " + shown(existing));
    }
    try {
        check_writable(existing / "dfdyn");
    } catch (const InputError& error) {
        throw InputError(shown(folder) + ": expected a folder to write in: " + error.what());
    }
}

void make_folder(const fs::path& folder) {
    refuse_dash(folder);
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        throw InputError(shown(folder) + ": cannot make the folder: " + error.message());
    }
}

void write_file(const fs::path& target, std::string_view content) {
    AtomicFile file(target);
    file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
    file.commit();
}

} // namespace dfdyn::tools
