// The lines of a NRRD header: its fields by their names.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace tet {

/// A header's fields, and what follows them.
struct NrrdFields {
  std::map<std::string, std::string> of;
  std::vector<std::string> listed_files;  ///< those after "data file: LIST"
  std::string attached;                   ///< its lines but those about files
  std::size_t end = 0;                    ///< where the data begin

  const std::string* find(const std::string& name) const;
  /// Refuses a header without it.
  const std::string& get(const std::string& name) const;
};

/// Reads all lines up to an empty one, or of a detached header to its end. Throws ImageRefusal.
NrrdFields read_nrrd_fields(std::span<const std::byte> head);

/// "I%03d.raw 1 10 1" becomes ten names. Throws ImageRefusal.
std::vector<std::string> numbered_files(const std::string& text);

}  // namespace tet
