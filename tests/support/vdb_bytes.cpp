#include "tests/support/vdb_bytes.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <sstream>
#include <stdexcept>

#include <openvdb/io/Archive.h>
#include <openvdb/tools/LevelSetSphere.h>

#include "core/vdb/walk/walk_vdb.h"

namespace tet::test {
namespace {

/// Opens up the writing of seekable files to a stream in memory.
class MemoryArchive : public openvdb::io::Archive {
 public:
  using Archive::write;
};

openvdb::FloatGrid::Ptr small_ball(const std::string& name) {
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.5F, {20, 21, 22}, 1);
  grid->setName(name);
  return grid;
}

/// The grid has no class, so that zlib is used where it is asked for.
std::string small_file(std::uint32_t compression, bool half, bool offsets) {
  const auto grid = small_ball("ball");
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  grid->setSaveFloatAsHalf(half);
  return vdb_bytes({grid}, {compression, offsets});
}

}  // namespace

std::string vdb_bytes(const openvdb::GridCPtrVec& grids, const VdbWriting& writing) {
  openvdb::initialize();
  std::ostringstream out(std::ios::binary);
  MemoryArchive archive;
  archive.setCompression(writing.compression);
  archive.write(out, grids, writing.offsets, openvdb::MetaMap());
  return out.str();
}

std::vector<std::string> small_files() {
  using namespace openvdb::io;  // NOLINT(google-build-using-namespace): its flags
  openvdb::initialize();
  const auto first = small_ball("first");
  const auto second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  return {small_file(COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK, false, true),
          small_file(COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK, true, false),
          small_file(COMPRESS_ZIP | COMPRESS_ACTIVE_MASK, false, true),
          small_file(COMPRESS_ACTIVE_MASK, true, true),
          small_file(COMPRESS_BLOSC, false, true),
          vdb_bytes({first, second}),
          vdb_bytes({openvdb::FloatGrid::create(1), first}),
          vdb_bytes({})};
}

absl::StatusOr<VdbOutline> walk_bytes(const std::string& bytes, std::vector<VdbField>* fields) {
  return walk_vdb(ByteSource(std::as_bytes(std::span(bytes))), {}, fields);
}

VdbField find_field(const std::string& bytes, const std::string& what, std::size_t nth) {
  std::vector<VdbField> fields;
  const auto outline = walk_bytes(bytes, &fields);
  if (!outline.ok()) throw std::runtime_error(outline.status().ToString());
  for (const VdbField& field : fields) {
    if (field.what == what && nth-- == 0) return field;
  }
  throw std::runtime_error("there is no field " + what);
}

std::string with_lie(std::string bytes,
                     const std::string& what,
                     std::size_t nth,
                     std::uint64_t value) {
  const VdbField field = find_field(bytes, what, nth);
  for (std::size_t i = 0; i < std::min<std::uint64_t>(field.bytes, sizeof(value)); ++i) {
    bytes[field.offset + i] = static_cast<char>(value >> (8 * i) & 0xff);
  }
  return bytes;
}

}  // namespace tet::test
