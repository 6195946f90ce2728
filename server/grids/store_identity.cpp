#include "server/grids/store_identity.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <random>
#include <string_view>
#include <unistd.h>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "server/ops/disk.h"

namespace tet {

namespace {

constexpr std::size_t kIdentityDigits = 32;

bool is_identity(std::string_view text) {
  return text.size() == kIdentityDigits && std::ranges::all_of(text, absl::ascii_isxdigit);
}

std::string new_identity() {
  std::random_device random;
  std::string text;
  while (text.size() < kIdentityDigits) absl::StrAppendFormat(&text, "%08x", random());
  return text;
}

}  // namespace

absl::StatusOr<std::string> read_store_identity(const std::filesystem::path& store) {
  const auto file = open_file(store / kStoreIdentityFile, O_RDONLY);
  if (!file.ok()) return file.status();
  std::array<char, kIdentityDigits + 2> bytes{};
  const auto size = file->read_at(0, bytes);
  if (!size.ok()) return size.status();
  const std::string text(absl::StripAsciiWhitespace({bytes.data(), *size}));
  if (is_identity(text)) return text;
  return absl::DataLossError(absl::StrCat(kStoreIdentityFile, " of the store does not hold ",
                                          kIdentityDigits, " hexadecimal digits"));
}

absl::StatusOr<std::string> make_store_identity(const std::filesystem::path& store) {
  auto found = read_store_identity(store);
  if (!absl::IsNotFound(found.status())) return found;
  const std::string identity = new_identity();
  auto file =
      AtomicFile::create_at(store / kStoreIdentityFile, {"", ".part", kFileMode, disk_error});
  if (!file.ok()) return file.status();
  const std::string line = absl::StrCat(identity, "\n");
  absl::Status made = file->write(std::as_bytes(std::span(line)));
  if (made.ok()) made = file->seal();
  if (!made.ok()) return made;
  // A link replaces nothing: of several servers that begin with a new store one makes it.
  if (::link(file->temporary_path().c_str(), file->path().c_str()) != 0) {
    if (errno != EEXIST) return disk_error("create", file->path());
    return read_store_identity(store);
  }
  made = sync_folder(store);
  if (!made.ok()) return made;
  return identity;
}

}  // namespace tet
