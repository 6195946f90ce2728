// Scenes that several tests mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "core/scene/scene_nodes.h"

namespace tet::test {

/// A description of nodes whose names are "0", "1", ...
class SceneWriter {
 public:
  /// Adds a node; its name.
  template <class Kind>
  std::string add(Kind kind) {
    const std::string name = std::to_string(description_.nodes.size());
    description_.nodes.push_back({name, std::move(kind)});
    return name;
  }
  std::string add_moved(Triple by, std::string of) {
    scene::Transform moved;
    moved.of = std::move(of);
    moved.translation = by;
    return add(moved);
  }
  const scene::Description& description() const { return description_; }
  /// Aborts where make_scene refuses.
  Scene scene() const;

 private:
  scene::Description description_;
};

/// A scene whose boundary is known, where its features are resolved by `spacing`.
struct KnownScene {
  std::string name;
  Scene scene;
  double spacing = 0.1;
  std::uint64_t components = 1;           ///< of the boundary
  std::int64_t euler_characteristic = 2;  ///< of the whole boundary
  double enclosed_volume = 0;             ///< 0 where it is not known
};

/// Every primitive, and operators whose result is known.
std::vector<KnownScene> known_scenes();

/// A random tree of primitives and operators within about 2 of the origin: the same for the
/// same seed. Some have no inside.
scene::Description random_scene(std::uint32_t seed);

}  // namespace tet::test
