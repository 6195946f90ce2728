// Scratch memory that a task reuses from chunk to chunk.
#pragma once

#include <memory>
#include <typeindex>
#include <utility>
#include <vector>

namespace tet {

/// Holds one object of each type that was asked for: every kind of plan brings its own. Not
/// thread-safe: one per task.
class MeshWorkspace {
 public:
  /// The object is made, without initial values, when it is first asked for.
  template <class Scratch>
  Scratch& get();

 private:
  std::vector<std::pair<std::type_index, std::shared_ptr<void>>> held_;
};

template <class Scratch>
Scratch& MeshWorkspace::get() {
  const std::type_index type = typeid(Scratch);
  for (const auto& [held, object] : held_) {
    if (held == type) return *static_cast<Scratch*>(object.get());
  }
  const std::shared_ptr<Scratch> made(new Scratch);
  held_.emplace_back(type, made);
  return *made;
}

}  // namespace tet
