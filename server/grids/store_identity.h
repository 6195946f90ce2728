// What tells one store of files from another, and from a folder where none is mounted.
#pragma once

#include <filesystem>
#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// The file of a store that has its identity: 32 hexadecimal digits, made once.
inline constexpr char kStoreIdentityFile[] = "store-id";

/// Errors: kNotFound (no such file, or no such folder), kDataLoss (it holds something else),
/// the disk's.
absl::StatusOr<std::string> read_store_identity(const std::filesystem::path& store);

/// Reads the identity, or makes it where there is none; all who do so at once get the same one.
/// Errors: kDataLoss, the disk's.
absl::StatusOr<std::string> make_store_identity(const std::filesystem::path& store);

}  // namespace tet
