// Grids whose values are wanted at a mesh's vertices, as a caller asks for them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "core/mesh/tet_mesh.h"
#include "core/volume/volume.h"

namespace tet {

struct VertexField {
  std::string name = {};  ///< of the array in the mesh; empty: the grid's
  std::string file = {};  ///< for whoever loads it; empty: that of the grid that is meshed
  std::string grid = {};  ///< within the file; empty: its only one that can be a field
  /// A volume for each component; loaded before anything is meshed.
  std::vector<std::shared_ptr<const Volume>> components = {};

  static constexpr std::size_t kMaxFields = 16;
  static constexpr std::size_t kMaxNameBytes = 128;
};

/// The fields of a request: what refusals begin with.
inline constexpr char kFieldsField[] = "fields";

// Each is OK or kInvalidArgument, and the message begins with the field that is wrong, as
// `fields[3].name`, and says its value and what it may be.

/// Checks the names as far as they are known: a grid's is known when it is loaded.
absl::Status check_fields(std::span<const VertexField> fields);

/// Checks that all of them are loaded, too.
absl::Status check_loaded_fields(std::span<const VertexField> fields);

/// The arrays that they become; they are loaded.
std::vector<FieldArray> arrays_of(std::span<const VertexField> fields);

/// Whether every file format can name an array so: UTF-8 of at most kMaxNameBytes, without
/// control characters, `/` and `"`, and not a dot.
bool is_array_name(const std::string& name);

}  // namespace tet
