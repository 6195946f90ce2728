#include "core/image/join_image.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <sys/stat.h>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/file.h"
#include "core/image/image_refusal.h"
#include "core/image/meta_header.h"
#include "core/image/nrrd_header.h"
#include "core/image/text_header.h"

namespace tet {
namespace {

namespace fs = std::filesystem;

/// A header's bytes, with the end of a last line that has none.
std::vector<std::byte> read_head(const std::string& path) {
  const absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  if (!file.ok()) throw ImageRefusal(file.status());
  std::vector<char> bytes(kTextHeaderBytes);
  const absl::StatusOr<std::size_t> count = file->read_at(0, bytes);
  if (!count.ok()) throw ImageRefusal(count.status());
  bytes.resize(*count);
  bytes.push_back('\n');
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

DetachedHeader read_detached(std::span<const std::byte> head) {
  return is_nrrd(head) ? read_detached_nrrd(head) : read_detached_meta(head);
}

/// A file that a header names, from the header's folder on.
fs::path path_of_data(const std::string& name) {
  const fs::path path(name);
  const bool stays = !path.is_absolute() &&
                     std::none_of(path.begin(), path.end(), [](auto& p) { return p == ".."; });
  if (!stays || name.find('\0') != std::string::npos) {
    refuse_image(absl::StrCat("its data are in ", quoted_text(name),
                              ", and only files beside it are read: move them there, and name "
                              "them without a path"));
  }
  return path;
}

/// Tells why a part of the way to a file of data was not opened.
[[noreturn]] void refuse_way(const fs::path& header,
                             const fs::path& path,
                             const fs::path& part) {
  if (errno != ELOOP && errno != ENOTDIR) {
    throw ImageRefusal(io_error("open", header.parent_path() / path));
  }
  refuse_image(absl::StrCat("its data are in ", quoted_text(path.native()), ", where ",
                            quoted_text(part.native()),
                            " is a link or no folder, and links are not followed: put the data "
                            "themselves there"));
}

/// The folder that a header lies in, which whoever named the header has chosen, links or not.
Descriptor open_folder_of(const std::string& header) {
  const fs::path parent = fs::path(header).parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  Descriptor opened = open_descriptor(folder, O_PATH | O_DIRECTORY);
  if (!opened.is_open()) throw ImageRefusal(io_error("open", folder));
  return opened;
}

/// A file of data, open. The way to it goes from one folder to the next: of a whole path the
/// system would follow links to folders.
File open_data(const std::string& header, const std::string& name) {
  const fs::path path = path_of_data(name);
  Descriptor folder = open_folder_of(header);
  for (const fs::path& part : path.parent_path()) {
    folder = open_descriptor_in(folder, part, O_PATH | O_DIRECTORY | O_NOFOLLOW);
    if (!folder.is_open()) refuse_way(header, path, part);
  }
  constexpr int kFlags = O_RDONLY | O_NONBLOCK | O_NOFOLLOW;
  File file(open_descriptor_in(folder, path.filename(), kFlags),
            fs::path(header).parent_path() / path, io_error);
  if (!file.descriptor().is_open()) refuse_way(header, path, path.filename());
  const auto mode = file.mode();
  if (!mode.ok() || !S_ISREG(*mode)) {
    refuse_image(absl::StrCat("its data are in ", quoted_text(name), ", which is no file"));
  }
  return file;
}

/// A file that is made of others, one after the other, until somebody cancels it.
struct Joined {
  File file;
  const Cancellation& cancellation;
};

/// Appends bytes [from, end) of a file.
void append(const File& from_file, std::uint64_t from, std::uint64_t end, Joined& to) {
  std::vector<char> buffer(std::size_t{1} << 20);
  while (from < end) {
    const absl::Status wanted = check_cancelled(to.cancellation);
    if (!wanted.ok()) throw ImageRefusal(wanted);
    const auto piece =
        static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), end - from));
    const auto count = from_file.read_at(from, std::span(buffer).first(piece));
    if (!count.ok()) throw ImageRefusal(count.status());
    if (*count == 0) refuse_image("a file of its data is cut while it is read");
    const absl::Status written = to.file.append(std::string_view(buffer.data(), *count));
    if (!written.ok()) throw ImageRefusal(written);
    from += *count;
  }
}

/// Appends the `bytes` of data that a file stores, or all that it has where they are packed.
void append_data(const std::string& header,
                 const std::string& name,
                 const DetachedHeader& detached,
                 std::optional<std::uint64_t> bytes,
                 Joined& joined) {
  const File file = open_data(header, name);
  const absl::StatusOr<std::uint64_t> size = file.size();
  if (!size.ok()) throw ImageRefusal(size.status());
  const std::uint64_t skip =
      !detached.skip_to_last ? detached.skip_bytes : *size - std::min(*size, bytes.value_or(0));
  if (skip > *size || *size - skip < bytes.value_or(1)) {
    refuse_image(
        absl::StrFormat("its data file %s is truncated: %d bytes of it are data, and %d "
                        "are needed",
                        quoted_text(name), *size - std::min(*size, skip), bytes.value_or(1)));
  }
  append(file, skip, bytes ? skip + *bytes : *size, joined);
}

void join(const std::string& header,
          const std::string& path,
          const Cancellation& cancellation) {
  const DetachedHeader detached = read_detached(read_head(header));
  absl::StatusOr<File> made = File::open(path, O_WRONLY | O_CREAT | O_EXCL, io_error, 0600);
  if (!made.ok()) throw ImageRefusal(made.status());
  Joined joined{*std::move(made), cancellation};
  const absl::Status begun = joined.file.append(detached.attached);
  if (!begun.ok()) throw ImageRefusal(begun);
  const std::uint64_t files = detached.files.size();
  if (detached.data_bytes % files != 0) {
    refuse_image(absl::StrFormat("its %d bytes do not divide into %d files",
                                 detached.data_bytes, files));
  }
  std::optional<std::uint64_t> bytes;
  if (detached.data_bytes > 0) bytes = detached.data_bytes / files;
  for (const std::string& name : detached.files) {
    append_data(header, name, detached, bytes, joined);
  }
  const absl::Status closed = joined.file.close();
  if (!closed.ok()) throw ImageRefusal(closed);
}

}  // namespace

bool is_detached_image(const std::string& path) {
  try {
    const std::vector<std::byte> head = read_head(path);
    return is_detached_nrrd(head) || is_detached_meta(head);
  } catch (const ImageRefusal&) {
    return false;  // whoever reads it says what is wrong
  }
}

std::vector<std::string> data_files_of(const std::string& header) {
  std::vector<std::string> files;
  if (!is_detached_image(header)) return files;
  try {
    for (const std::string& name : read_detached(read_head(header)).files) {
      files.push_back(fs::path(header).parent_path() / name);
    }
  } catch (const ImageRefusal&) {
    files.clear();
  }
  return files;
}

absl::Status join_image(const std::string& header,
                        const std::string& joined,
                        const Cancellation& cancellation) {
  try {
    join(header, joined, cancellation);
    return absl::OkStatus();
  } catch (const ImageRefusal& refusal) {
    return {refusal.status().code(),
            absl::StrCat("'", header, "': ", refusal.status().message())};
  }
}

}  // namespace tet
