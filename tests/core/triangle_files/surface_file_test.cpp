#include "core/triangle_files/surface_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/thread_time.h"
#include "core/surface/close_surface.h"
#include "tests/support/sanitized.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Corners = std::array<std::uint32_t, 3>;
using Reader = absl::StatusOr<TriangleSurface> (*)(std::string_view);

constexpr const char* kBunny = "/usr/share/glmark2/models/bunny.obj";

/// The bytes of numbers, one after the other.
template <class... Numbers>
std::string packed(Numbers... numbers) {
  std::string bytes;
  const auto append = [&](auto number) {
    char raw[sizeof(number)];
    std::memcpy(raw, &number, sizeof(number));
    bytes.append(raw, sizeof(number));
  };
  (append(numbers), ...);
  return bytes;
}

std::string message(const absl::StatusOr<TriangleSurface>& surface) {
  EXPECT_EQ(surface.status().code(), absl::StatusCode::kInvalidArgument) << surface.status();
  return std::string(surface.status().message());
}

TEST(ReadObj, ReadsEveryFormOfACorner) {
  const auto surface = read_obj(
      "# a comment\n"
      "mtllib x.mtl\r\n"
      "v 0 0 0\nv 1 0 0 1.0\n  v 1 1e0 -.5\nv 0 +1 0\nvt 0 0\nvn 0 0 1\n"
      "g side\ns off\n"
      "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 4//1\nf 1/1/1 3/1/1 4/1/1 # here\nf -4 -3 -1");
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->vertices[2], (WorldPoint{1, 1, -0.5}));
  EXPECT_THAT(surface->triangles,
              ElementsAre(Corners{0, 1, 2}, Corners{0, 1, 2}, Corners{0, 1, 3},
                          Corners{0, 2, 3}, Corners{0, 1, 3}));
}

TEST(ReadObj, CutsAPolygonIntoAFan) {
  const auto surface = read_obj("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n");
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_THAT(surface->triangles,
              ElementsAre(Corners{0, 1, 2}, Corners{0, 2, 3}, Corners{0, 3, 4}));
}

TEST(ReadObj, ReadsTextAsProgramsWriteIt) {
  for (const char* text : {
           "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
           "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
           "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\r\n2 \\\r\n3",
           "# C:\\\nv 0 0 0\no a\\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
           "v 0 0 0 1 .5 .5\nv 1 0 1e-999\nv 0 1 0\nfo 1// 2// 3//\n",
       }) {
    const auto surface = read_obj(text);
    ASSERT_TRUE(surface.ok()) << surface.status() << '\n' << text;
    EXPECT_THAT(surface->vertices,
                ElementsAre(WorldPoint{0, 0, 0}, WorldPoint{1, 0, 0}, WorldPoint{0, 1, 0}));
    EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}));
  }
}

TEST(ReadObj, LeavesNoSurfaceOutThatItCannotRead) {
  EXPECT_THAT(message(read_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nsurf 0 1 0 1 1 2 3\n")),
              HasSubstr("line 5: 'surf'"));
  EXPECT_THAT(message(read_obj("call more.obj\n")), HasSubstr("line 1: 'call'"));
  EXPECT_THAT(message(read_obj("\xFF\xFEv")), HasSubstr("UTF-16"));
}

TEST(ReadObj, NamesTheLineThatIsWrong) {
  EXPECT_THAT(message(read_obj("v 0 0 0\nv 0 0\n")), HasSubstr("line 2"));
  EXPECT_THAT(message(read_obj("v 0 0 nan\n")), HasSubstr("line 1"));
  EXPECT_THAT(message(read_obj("v 0 1e999 0\n")), HasSubstr("line 1"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 1 2\n")),
              HasSubstr("line 2: the face names vertex 2, but there are 1 before it"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 1 -2\n")), HasSubstr("vertex -2"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 1 0\n")), HasSubstr("vertex 0"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 1\n")), HasSubstr("2 corners"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 one 1\n")), HasSubstr("'one'"));
  EXPECT_THAT(message(read_obj("v 0 0 0\nf 1 1 99999999999999999999\n")), HasSubstr("line 2"));
  EXPECT_THAT(message(read_obj("v 0 0 0\n")), HasSubstr("no triangle"));
  EXPECT_THAT(message(read_obj("")), HasSubstr("no triangle"));
}

TEST(ReadObj, ReadsTheBunnyAsAClosedSurface) {
  const auto surface = read_surface(kBunny);
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->vertices.size(), 34835U);
  EXPECT_EQ(surface->triangles.size(), 69666U);
  const ClosedSurface closed = close_surface(*surface, 1e-6, 1e-6);
  EXPECT_EQ(closed.open_edges, 0U);
  EXPECT_EQ(closed.non_manifold_edges, 0U);
}

constexpr const char* kAsciiStl =
    "solid two\n"
    " facet normal 0 0 1\n  outer loop\n"
    "   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\n"
    " facet normal 0 0 1\n  outer loop\n"
    "   vertex 1 0 0\n   vertex 1 1 0\n   vertex 0 1 -0\n  endloop\n endfacet\n"
    "endsolid two\n";

std::string binary_stl(std::uint32_t claimed, const std::string& header = "") {
  std::string bytes = header;
  bytes.resize(80, ' ');
  bytes += packed(claimed);
  bytes += packed(0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, std::uint16_t{0});
  bytes +=
      packed(0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, -0.F, std::uint16_t{7});
  return bytes;
}

TEST(ReadStl, GivesEqualCornersOneVertexInTextAndInBinary) {
  for (const std::string& bytes :
       {std::string(kAsciiStl), binary_stl(2), binary_stl(2, "solid, yet binary")}) {
    const auto surface = read_stl(bytes);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_EQ(surface->vertices.size(), 4U);
    EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}, Corners{1, 3, 2}));
  }
}

TEST(ReadStl, RefusesWhatItsSizeDoesNotAllow) {
  EXPECT_THAT(message(read_stl(binary_stl(3))), HasSubstr("claims 3 triangles"));
  EXPECT_THAT(message(read_stl(binary_stl(0xFFFFFFFF))), HasSubstr("claims 4294967295"));
  EXPECT_THAT(message(read_stl(binary_stl(0))), HasSubstr("claims 0 triangles"));
  EXPECT_THAT(message(read_stl(binary_stl(0).substr(0, 84))), HasSubstr("no triangle"));
  // A count that leaves triangles out, whatever follows.
  for (const char* more : {"", "x"}) {
    EXPECT_THAT(message(read_stl(binary_stl(1) + more)),
                HasSubstr("byte 80: it claims 1 triangles, but its"));
  }
  EXPECT_THAT(message(read_stl("")), HasSubstr("0 bytes"));
  EXPECT_THAT(message(read_stl("solid")), HasSubstr("no triangle"));
}

TEST(ReadStl, ReadsBinaryFilesThatBeginAsTextDoesOrEndInForeignBytes) {
  for (const std::string header : {"solid", "solid facet normal 0 0 1 vertex 0 0 0", ""}) {
    for (const std::string& end :
         {std::string("\n"), std::string("ab"), std::string(512, '\0')}) {
      const auto surface = read_stl(binary_stl(2, header) + end);
      ASSERT_TRUE(surface.ok()) << surface.status();
      EXPECT_EQ(surface->triangles.size(), 2U);
    }
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

TEST(ReadStl, ReadsTextAsProgramsWriteIt) {
  const std::string text = kAsciiStl;
  std::string upper = text;
  std::transform(upper.begin(), upper.end(), upper.begin(), ::toupper);
  const std::vector<std::string> files{
      replaced(text, "\n", "\r"),
      replaced(text, "\n", "\r\n"),
      replaced(text, "\n", " "),
      replaced(text, " two\n", "\n"),
      replaced(text, "two", "two facets of a vertex 1 2"),
      replaced(replaced(text, "\n", " "), "two", "two facet normals or a facet"),
      replaced(text, "0 0 1\n", "nan -nan(ind) 1\n"),
      upper,
      "\xEF\xBB\xBF" + text,
      "\n \n; exported\n# by hand\n" + text,
      "  " + text,
  };
  for (const std::string& file : files) {
    const auto surface = read_stl(file);
    ASSERT_TRUE(surface.ok()) << surface.status() << '\n' << file;
    EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}, Corners{1, 3, 2})) << file;
  }
  EXPECT_EQ(read_stl(text + replaced(text, "two", "three"))->triangles.size(), 4U);
}

/// The processor time of reading a file of two triangles.
std::chrono::nanoseconds time_to_read(const std::string& stl) {
  const std::chrono::nanoseconds before = thread_time();
  const auto surface = read_stl(stl);
  EXPECT_TRUE(surface.ok() && surface->triangles.size() == 2) << surface.status();
  return thread_time() - before;
}

TEST(ReadStl, TakesLongNamesInOneGo) {
  // Many minutes, if each word were looked for in all that follows it.
  constexpr std::size_t kWords = 300'000;
  for (const char* word : {"facet", "facet ", " facet normal solid", "solid "}) {
    std::string name = "solid ";
    for (std::size_t i = 0; i < kWords; ++i) name += word;
    EXPECT_LT(time_to_read(name + "\n" + kAsciiStl), std::chrono::seconds(30)) << word;
  }
}

double with_bits(std::uint64_t bits) { return std::bit_cast<double>(bits); }

/// Facets whose corners all have one hash: that of a table which the welder once had.
std::string facets_of_one_hash(std::size_t count) {
  std::mt19937_64 random(5);  // NOLINT(cert-msc51-cpp): the same corners every time
  std::string text = "solid\n";
  const auto append = [&](double number) {
    std::array<char, 32> digits{};
    text += ' ';
    text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), number).ptr);
  };
  for (std::size_t corner = 0; corner < 3 * count;) {
    const double x = std::ldexp(static_cast<double>(random() >> 11), -50), y = 1;
    std::uint64_t hash = 0;
    for (const double v : {x, y}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32;
    }
    if (!std::isfinite(with_bits(hash))) continue;
    text += "vertex";
    for (const double v : {x, y, with_bits(hash)}) append(v);
    text += ++corner % 3 == 0 ? "\nendfacet\n" : "\n";
  }
  return text;
}

TEST(ReadStl, WeldsCornersOfEqualHashesAsFastAsOthers) {
  // Minutes, if each corner were compared with all others.
  constexpr std::size_t kFacets = test::sanitized_or<std::size_t>(20'000, 100'000);
  const std::string text = facets_of_one_hash(kFacets);
  const std::chrono::nanoseconds before = thread_time();
  const auto surface = read_stl(text);
  EXPECT_LT(thread_time() - before, std::chrono::seconds(30));
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->vertices.size(), 3 * kFacets);
}

TEST(ReadStl, NumbersVerticesByTheirFirstCorners) {
  const auto surface = read_stl(
      "solid\nvertex 9 0 0\nvertex 5 0 0\nvertex 7 0 1\nendfacet\n"
      "vertex 5 -0 0\nvertex 1 0 0\nvertex 7 0 1\nendfacet\n");
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_THAT(surface->vertices, ElementsAre(WorldPoint{9, 0, 0}, WorldPoint{5, 0, 0},
                                             WorldPoint{7, 0, 1}, WorldPoint{1, 0, 0}));
  EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}, Corners{1, 3, 2}));
}

TEST(ReadStl, NamesThePlaceThatIsWrong) {
  std::string bytes = binary_stl(2);
  const std::string nan = packed(std::numeric_limits<float>::quiet_NaN());
  bytes.replace(84 + 50 + 12 + 12 + 4, 4, nan);
  EXPECT_THAT(message(read_stl(bytes)), HasSubstr("byte 158: triangle 1"));
  EXPECT_THAT(message(read_stl("solid\nfacet\nvertex 0 0\n")), HasSubstr("line 3"));
  EXPECT_THAT(message(read_stl("solid\nfacet\nvertex 0 0 0\nendfacet\n")),
              HasSubstr("line 4: a facet has 1 vertices"));
  EXPECT_THAT(message(read_stl("solid\nvertex 0 0 0\nvertex 0 0 1\n")), HasSubstr("not end"));
}

const std::string kPlyHeader =
    " 1.0\ncomment made by hand\nobj_info none\nelement vertex 4\n"
    "property uchar red\nproperty float x\nproperty double y\nproperty short z\n"
    "element edge 1\nproperty int vertex1\nproperty list uchar int more\n"
    "element face 2\nproperty list uchar uint vertex_indices\nproperty uchar flags\n"
    "end_header\n";

std::string ascii_ply() {
  return "ply\nformat ascii" + kPlyHeader +
         "255 0 0 0\n0 1 0 0\n0 1 1.5 0\n9 0 1 -3\n7 2 8 9\n3 0 1 2 1\n4 0 1 2 3 0\n";
}

std::string little(std::string number) { return number; }
std::string big(std::string number) { return {number.rbegin(), number.rend()}; }

std::string binary_ply(bool is_big) {
  const auto number = [&](auto value) { return (is_big ? big : little)(packed(value)); };
  const auto vertex = [&](float x, double y, short z) {
    return number(std::uint8_t{9}) + number(x) + number(y) + number(z);
  };
  const auto list = [&](std::initializer_list<std::uint32_t> ids) {
    std::string bytes = number(static_cast<std::uint8_t>(ids.size()));
    for (const std::uint32_t id : ids) bytes += number(id);
    return bytes;
  };
  return std::string("ply\nformat binary_") + (is_big ? "big" : "little") + "_endian" +
         kPlyHeader + vertex(0, 0, 0) + vertex(1, 0, 0) + vertex(1, 1.5, 0) + vertex(0, 1, -3) +
         number(std::int32_t{-7}) + list({8, 9}) + list({0, 1, 2}) + number(std::uint8_t{1}) +
         list({0, 1, 2, 3}) + number(std::uint8_t{0});
}

TEST(ReadPly, ReadsEveryFormat) {
  for (const std::string& bytes : {ascii_ply(), binary_ply(false), binary_ply(true)}) {
    const auto surface = read_ply(bytes);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_THAT(surface->vertices, ElementsAre(WorldPoint{0, 0, 0}, WorldPoint{1, 0, 0},
                                               WorldPoint{1, 1.5, 0}, WorldPoint{0, 1, -3}));
    EXPECT_THAT(surface->triangles,
                ElementsAre(Corners{0, 1, 2}, Corners{0, 1, 2}, Corners{0, 2, 3}));
  }
}

/// A line end of each kind, and a body that begins with one.
TEST(ReadPly, ReadsHeadersOfEveryLineEnd) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string header = replaced(
        "ply\nformat binary_big_endian 1.0\n\ncomment x\nelement vertex 3\n"
        "property uchar first\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar uint64 vertex_indices\nend_header\n",
        "\n", end);
    const auto vertex = [](float x, float y) {
      return "\n" + big(packed(x)) + big(packed(y)) + big(packed(0.F));
    };
    std::string bytes = header + vertex(0, 0) + vertex(1, 0) + vertex(0, 1) + "\3";
    for (const std::uint64_t id : {0U, 1U, 2U}) bytes += big(packed(id));
    const auto surface = read_ply(bytes);
    ASSERT_TRUE(surface.ok()) << surface.status();
    EXPECT_EQ(surface->vertices[1], (WorldPoint{1, 0, 0}));
    EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}));
  }
}

TEST(ReadPly, ReadsStripsOfTriangles) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n5 5 5\n";
  const auto surface = read_ply(start + "9 0 1 2 3 4 -1 0 1 5\n");
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_THAT(surface->triangles, ElementsAre(Corners{0, 1, 2}, Corners{2, 1, 3},
                                              Corners{2, 3, 4}, Corners{0, 1, 5}));
  EXPECT_THAT(message(read_ply(start + "3 0 1 -2\n")), HasSubstr("strip 0 names vertex -2"));
}

/// A notched square: a fan of its first corner has a triangle outside.
TEST(ReadPly, CutsPolygonsByTheirVerticesWhicheverComeFirst) {
  const std::string points =
      "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string places = "0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n0 2 0\n", corners = "5 0 1 2 3 4\n";
  const std::string start = "ply\nformat ascii 1.0\n", end = "end_header\n";
  const auto usual = read_ply(start + points + faces + end + places + corners);
  const auto other = read_ply(start + faces + points + end + corners + places);
  ASSERT_TRUE(usual.ok() && other.ok()) << usual.status() << other.status();
  EXPECT_EQ(usual->triangles.size(), 3U);
  EXPECT_EQ(other->triangles, usual->triangles);
  EXPECT_THAT(usual->triangles, ::testing::Not(::testing::Contains(Corners{0, 2, 3})));
}

TEST(ReadPly, TakesAnyNumberWhereItNeedsNone) {
  const auto surface = read_ply(replaced(ascii_ply(), "255 0 0 0", "nan 0 0 0"));
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_TRUE(read_ply("\xEF\xBB\xBF" + ascii_ply() + " \n").ok());
}

TEST(ReadPly, LeavesNoFaceOut) {
  EXPECT_THAT(message(read_ply(ascii_ply() + "3 0 1 2 1\n")), HasSubstr("more follows"));
  EXPECT_THAT(message(read_ply(replaced(ascii_ply(), "vertex_indices", "corners"))),
              HasSubstr("'face' has no list 'vertex_indices'"));
}

TEST(ReadPly, RefusesEveryTruncation) {
  for (const std::string& bytes : {ascii_ply(), binary_ply(false), binary_ply(true)}) {
    // The text may lose its last line end and still be whole.
    for (std::size_t size = 0; size + 1 < bytes.size(); ++size) {
      message(read_ply(bytes.substr(0, size)));
    }
  }
}

TEST(ReadPly, BelievesNoCountThatTheFileCannotHold) {
  const std::string end = "property float x\nproperty float y\nproperty float z\nend_header\n";
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string start = std::string("ply\nformat ") + format + " 1.0\n";
    EXPECT_THAT(message(read_ply(start + "element vertex 9000000000000000000\n" + end)),
                HasSubstr("9000000000000000000 times 'vertex'"));
  }
  EXPECT_THAT(
      message(read_ply("ply\nformat ascii 1.0\nelement face 1\n"
                       "property list uint int vertex_indices\nend_header\n4000000000\n")),
      HasSubstr("claims 4000000000 entries"));
  EXPECT_THAT(message(read_ply("ply\nformat ascii 1.0\nelement face 1\n"
                               "property list int int vertex_indices\nend_header\n-1 2\n")),
              HasSubstr("no length"));
}

TEST(ReadPly, NamesThePlaceThatIsWrong) {
  const auto with = [](std::string what, const std::string& by) {
    std::string text = ascii_ply();
    return text.replace(text.find(what), what.size(), by);
  };
  EXPECT_THAT(message(read_ply(with("ply\n", "plx\n"))), HasSubstr("line 1"));
  EXPECT_THAT(message(read_ply(with("ascii", "morse"))), HasSubstr("line 2: unknown format"));
  EXPECT_THAT(message(read_ply(with("short z", "short w"))), HasSubstr("no property 'z'"));
  EXPECT_THAT(message(read_ply(with("short z", "quad z"))), HasSubstr("unknown type 'quad'"));
  EXPECT_THAT(message(read_ply(with("list uchar uint", "list float uint"))),
              HasSubstr("count"));
  EXPECT_THAT(message(read_ply(with("vertex 4", "vertex -4"))), HasSubstr("'-4'"));
  EXPECT_THAT(message(read_ply(with("1.5", "inf"))), HasSubstr("byte"));
  EXPECT_THAT(message(read_ply(with("3 0 1 2 1", "3 0 1 4 1"))),
              HasSubstr("names vertex 4, but there are 4"));
  EXPECT_THAT(message(read_ply(with("3 0 1 2 1", "3 0 1 -1 1"))), HasSubstr("vertex -1"));
  EXPECT_THAT(message(read_ply("ply\nformat ascii 1.0\nelement vertex 5\nend_header\n")),
              HasSubstr("no properties"));
}

TEST(ReadSurface, GoesByTheEnding) {
  const test::TestDirectory directory;
  test::write_bytes(directory.file("a.STL"), kAsciiStl);
  test::write_bytes(directory.file("b.ply"), ascii_ply());
  EXPECT_TRUE(read_surface(directory.file("a.STL")).ok());
  EXPECT_TRUE(read_surface(directory.file("b.ply")).ok());
  test::write_bytes(directory.file("c.off"), "OFF");
  EXPECT_THAT(message(read_surface(directory.file("c.off"))), HasSubstr(".obj, .stl or .ply"));
  EXPECT_EQ(read_surface(directory.file("d.obj")).status().code(), absl::StatusCode::kNotFound);
  test::write_bytes(directory.file("e.obj"), "f 1 2 3");
  EXPECT_THAT(message(read_surface(directory.file("e.obj"))), HasSubstr("e.obj': line 1"));
}

TEST(ReadSurface, SurvivesBytesThatChangedAtRandom) {
  std::mt19937 random(71);  // NOLINT(cert-msc51-cpp): the same bytes every time
  const std::vector<std::pair<Reader, std::string>> files{
      {read_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2//2 -1\nf 1 2 3 1\n"},
      {read_stl, kAsciiStl},
      {read_stl, binary_stl(2)},
      {read_ply, ascii_ply()},
      {read_ply, binary_ply(false)},
      {read_ply, binary_ply(true)},
  };
  for (const auto& [read, original] : files) {
    for (int i = 0; i < 3000; ++i) {
      std::string bytes = original;
      for (int change = 0; change <= i % 4; ++change) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      const auto surface = read(bytes);
      if (!surface.ok()) continue;
      for (const Corners& corners : surface->triangles) {
        for (const std::uint32_t id : corners) ASSERT_LT(id, surface->vertices.size());
      }
    }
  }
}

}  // namespace
}  // namespace tet
