// make_fixture KIND VOXEL OUT.vdb: one of the files that the tests read, for scripts.
#include <cstdlib>
#include <exception>
#include <iostream>

#include "tests/support/vdb_fixtures.h"

namespace {

int usage() {
  std::cerr << "usage: make_fixture KIND VOXEL OUT.vdb\nkinds:";
  for (const std::string_view kind : tet::test::fixture_kinds()) std::cerr << ' ' << kind;
  std::cerr << '\n';
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return usage();
  const double voxel = std::strtod(argv[2], nullptr);
  if (!(voxel > 0)) return usage();
  try {
    tet::test::write_fixture(argv[1], voxel, argv[3]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "make_fixture: " << error.what() << '\n';
    return usage();
  }
}
