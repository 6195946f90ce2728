// True files to make broken ones of: small, and of every kind that the walker tells apart.
#pragma once

#include <string>
#include <vector>

#include "tests/hostile/mutator.h"

namespace tet::test {

/// Made by OpenVDB, the same ones each time.
std::vector<SeedFile> seed_files();

}  // namespace tet::test
