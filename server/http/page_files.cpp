#include "server/http/page_files.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/string_view.h>

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 20;
constexpr absl::string_view kCompressedEnding = ".gz";
constexpr absl::string_view kIndex = "/index.html";

struct FileType {
  absl::string_view ending, type;
};
constexpr FileType kTypes[] = {
    {".html", "text/html; charset=utf-8"}, {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},   {".svg", "image/svg+xml"},
    {".txt", "text/plain; charset=utf-8"}, {".json", "application/json"}};

/// Beside the program where it was built, and below the same prefix where it was installed.
std::string usual_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder : {program / "../page", program / "../share/tetstream/page"}) {
    if (fs::exists(folder / "index.html", error)) return folder.string();
  }
  return {};
}

absl::Status unusable(const std::string& folder, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat("http_page \"", folder, "\" ", why));
}

absl::StatusOr<std::string> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (file) return bytes;
  return absl::InvalidArgumentError(absl::StrCat("cannot read ", path.string()));
}

absl::string_view type_of(absl::string_view name) {
  for (const FileType& type : kTypes) {
    if (absl::EndsWith(name, type.ending)) return type.type;
  }
  return {};
}

}  // namespace

absl::StatusOr<PageFiles> PageFiles::open(const std::string& named) {
  PageFiles page;
  const std::string folder = named.empty() ? usual_folder() : named;
  if (folder.empty()) return page;
  std::error_code error;
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file(error)) continue;
    bytes += entry.file_size(error);
    if (bytes > kMostBytes) {
      return unusable(folder, absl::StrCat("has more than ", kMostBytes, " bytes"));
    }
    std::string name =
        absl::StrCat("/", fs::relative(entry.path(), folder, error).generic_string());
    const bool gzipped = absl::EndsWith(name, kCompressedEnding);
    if (gzipped) name.resize(name.size() - kCompressedEnding.size());
    const absl::string_view type = type_of(name);
    if (type.empty())
      return unusable(folder, absl::StrCat("has a file of no known kind: ", name));
    auto read = bytes_of(entry.path());
    if (!read.ok()) return read.status();
    PageFile& file = page.files_[name];
    file.type = std::string(type);
    file.is_named_by_content = absl::StartsWith(name, "/assets/");
    (gzipped ? file.gzipped : file.bytes) = grpc::Slice(*read);
  }
  if (error || !page.files_.contains(kIndex)) return unusable(folder, "has no index.html");
  return page;
}

const PageFile* PageFiles::find(absl::string_view path) const {
  const auto found = files_.find(path == "/" ? kIndex : path);
  return found == files_.end() || found->second.bytes.size() == 0 ? nullptr : &found->second;
}

}  // namespace tet
