#include "tests/support/conformity.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/faces.h"

namespace tet {
namespace {

constexpr std::size_t kVerticesPerRange = 4096;

Offences find_bad_ids(const TetMesh& mesh) {
  Offences bad;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    auto tet = mesh.tet(i);
    std::sort(tet.begin(), tet.end());
    const bool repeated = std::adjacent_find(tet.begin(), tet.end()) != tet.end();
    if (repeated || tet.back() >= mesh.header.vertex_count) bad.add(i);
  }
  return bad;
}

double determinant(const WorldPoint& a,
                   const WorldPoint& b,
                   const WorldPoint& c,
                   const WorldPoint& d) noexcept {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const double vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  const double wx = d.x - a.x, wy = d.y - a.y, wz = d.z - a.z;
  return ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx);
}

Offences find_non_positive_tets(const TetMesh& mesh) {
  Offences found;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const auto [a, b, c, d] = mesh.tet(i);
    // Written so that a position that is not a number offends too.
    const bool positive = determinant(mesh.stored_position(a), mesh.stored_position(b),
                                      mesh.stored_position(c), mesh.stored_position(d)) > 0;
    if (!positive) found.add(i);
  }
  return found;
}

Offences find_unreferenced_vertices(const TetMesh& mesh) {
  std::vector<bool> referenced(mesh.header.vertex_count);
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    for (const std::uint64_t v : mesh.tet(i)) referenced[v] = true;
  }
  Offences found;
  for (std::uint64_t v = 0; v < referenced.size(); ++v) {
    if (!referenced[v]) found.add(v);
  }
  return found;
}

/// A position by its bits, which sort whatever they are, and the vertex there.
using Place = std::pair<std::array<std::uint64_t, 3>, std::uint64_t>;

Place place_of(const TetMesh& mesh, std::uint64_t vertex) {
  const auto [x, y, z] = mesh.stored_position(vertex);
  // Adding zero makes a positive zero of a negative one.
  const auto bits = [](double t) { return std::bit_cast<std::uint64_t>(t + 0.0); };
  return {{bits(x), bits(y), bits(z)}, vertex};
}

Offences find_duplicate_vertices(const TetMesh& mesh) {
  std::vector<Place> places;
  places.reserve(mesh.header.vertex_count);
  for (std::uint64_t v = 0; v < mesh.header.vertex_count; ++v) {
    places.push_back(place_of(mesh, v));
  }
  std::sort(places.begin(), places.end());
  Offences found;
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i].first == places[i - 1].first) found.add(places[i].second);
  }
  return found;
}

/// A face by number: tet * 4 + the corner opposite it.
using FaceNumber = std::uint64_t;

SortedFace sorted_face(const TetMesh& mesh, FaceNumber number) {
  return sort_face(face_of(mesh.tet(number / 4), number % 4));
}

/// The mesh's faces, gathered by their smallest vertex: those of vertex v at [first[v],
/// first[v+1]).
struct FacesByVertex {
  std::vector<std::uint64_t> first;
  std::vector<FaceNumber> faces;
};

/// The smallest vertex of each face of a tet, by the corner opposite it.
std::array<std::uint64_t, 4> smallest_vertices(
    const std::array<std::uint64_t, 4>& tet) noexcept {
  const auto [a, b, c, d] = tet;
  const std::uint64_t ab = std::min(a, b), cd = std::min(c, d);
  return {std::min(b, cd), std::min(a, cd), std::min(ab, d), std::min(ab, c)};
}

FacesByVertex gather_faces(const TetMesh& mesh) {
  const std::uint64_t tets = mesh.header.tet_count;
  std::vector<std::uint32_t> counts(mesh.header.vertex_count);
  for (std::uint64_t t = 0; t < tets; ++t) {
    for (const std::uint64_t v : smallest_vertices(mesh.tet(t))) ++counts[v];
  }
  FacesByVertex gathered;
  gathered.first = offsets_from_counts(counts.size(), [&](std::size_t v) { return counts[v]; });
  gathered.faces.resize(4 * tets);
  for (std::uint64_t t = 0; t < tets; ++t) {
    const auto smallest = smallest_vertices(mesh.tet(t));
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint64_t v = smallest[i];
      gathered.faces[gathered.first[v] + --counts[v]] = 4 * t + i;
    }
  }
  return gathered;
}

struct FaceFindings {
  Offences crowded, folded;
  std::uint64_t inner = 0, boundary = 0;

  void add(const FaceFindings& other) noexcept {
    crowded.add(other.crowded);
    folded.add(other.folded);
    inner += other.inner;
    boundary += other.boundary;
  }
};

using NumberedFace = std::pair<SortedFace, FaceNumber>;

/// Judges the tets that share one face.
void judge_face(std::span<const NumberedFace> sharing, FaceFindings& findings) {
  const std::uint64_t tet = sharing.front().second / 4;
  if (sharing.size() == 1) {
    ++findings.boundary;
  } else if (sharing.size() > 2) {
    findings.crowded.add(tet);
  } else if (sharing.front().first.flipped == sharing.back().first.flipped) {
    findings.folded.add(tet);
  } else {
    ++findings.inner;
  }
}

FaceFindings judge_faces_of_vertices(const TetMesh& mesh,
                                     const FacesByVertex& gathered,
                                     std::size_t begin,
                                     std::size_t end) {
  FaceFindings findings;
  std::vector<NumberedFace> around;
  for (std::size_t v = begin; v < end; ++v) {
    around.clear();
    for (std::uint64_t i = gathered.first[v]; i < gathered.first[v + 1]; ++i) {
      around.emplace_back(sorted_face(mesh, gathered.faces[i]), gathered.faces[i]);
    }
    std::sort(around.begin(), around.end());
    for (std::size_t run = 0, next = 0; run < around.size(); run = next) {
      while (next < around.size() &&
             around[next].first.vertices == around[run].first.vertices) {
        ++next;
      }
      judge_face(std::span(around).subspan(run, next - run), findings);
    }
  }
  return findings;
}

FaceFindings judge_faces(const TetMesh& mesh) {
  const FacesByVertex gathered = gather_faces(mesh);
  const std::size_t vertices = mesh.header.vertex_count;
  std::vector<FaceFindings> ranges((vertices + kVerticesPerRange - 1) / kVerticesPerRange);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::size_t begin = r * kVerticesPerRange;
    ranges[r] = judge_faces_of_vertices(mesh, gathered, begin,
                                        std::min(begin + kVerticesPerRange, vertices));
  });
  FaceFindings total;
  for (const FaceFindings& range : ranges) total.add(range);
  return total;
}

}  // namespace

bool ConformityReport::conforming() const noexcept { return describe().empty(); }

std::string ConformityReport::describe() const {
  std::string text;
  const auto say = [&](const Offences& offences, const char* what) {
    if (offences.count == 0) return;
    text += std::to_string(offences.count) + " " + what + ", first " +
            std::to_string(offences.first) + "\n";
  };
  say(bad_ids, "tets with bad vertex ids");
  say(non_positive_tets, "tets that are not positive");
  say(crowded_faces, "faces of three or more tets");
  say(folded_faces, "faces with both tets on one side");
  say(unreferenced_vertices, "unreferenced vertices");
  say(duplicate_vertices, "duplicate vertices");
  return text;
}

ConformityReport check_conformity(const TetMesh& mesh) {
  ConformityReport report;
  report.bad_ids = find_bad_ids(mesh);
  if (report.bad_ids.count > 0) return report;
  report.non_positive_tets = find_non_positive_tets(mesh);
  report.unreferenced_vertices = find_unreferenced_vertices(mesh);
  report.duplicate_vertices = find_duplicate_vertices(mesh);
  const FaceFindings faces = judge_faces(mesh);
  report.crowded_faces = faces.crowded;
  report.folded_faces = faces.folded;
  report.inner_faces = faces.inner;
  report.boundary_faces = faces.boundary;
  return report;
}

}  // namespace tet
