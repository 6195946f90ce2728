// What the readers of images say of files that lie: tests/data/hostile_image.
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/load_image.h"
#include "core/image/outline_image.h"

namespace tet {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string file_of(const std::string& name) {
  std::ifstream file(std::string(HOSTILE_IMAGE_PATH) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

ByteSource source_of(const std::string& bytes) {
  return ByteSource(std::as_bytes(std::span(bytes)));
}

struct Entry {
  std::string name, verdict;
};

std::vector<Entry> manifest() {
  std::ifstream file(std::string(HOSTILE_IMAGE_PATH) + "/MANIFEST.tsv");
  std::vector<Entry> entries;
  for (std::string line; std::getline(file, line);) {
    const std::size_t tab = line.find('\t');
    if (line.starts_with('#') || tab == std::string::npos) continue;
    entries.push_back({line.substr(0, tab), line.substr(tab + 1)});
  }
  return entries;
}

/// Reads a file in every way.
absl::Status verdict_on(const std::string& bytes) {
  const ByteSource source = source_of(bytes);
  if (const auto outline = outline_image(source); !outline.ok()) return outline.status();
  if (const auto arrays = list_image(source); !arrays.ok()) return arrays.status();
  return load_image(source, "", ImageUse::kSurface).status();
}

TEST(HostileImage, IsRefusedInTheWordsOfTheManifest) {
  const std::vector<Entry> entries = manifest();
  ASSERT_GT(entries.size(), 80U);
  for (const auto& [name, verdict] : entries) {
    const absl::Status status = verdict_on(file_of(name));
    if (verdict == "accepted") {
      EXPECT_TRUE(status.ok()) << name << ": " << status;
    } else {
      EXPECT_FALSE(status.ok()) << name;
      EXPECT_THAT(std::string(status.message()), HasSubstr(verdict)) << name;
    }
  }
}

TEST(HostileImage, IsRefusedOrReadWhereverItIsCut) {
  for (const auto& [name, verdict] : manifest()) {
    if (verdict != "accepted") continue;
    const std::string whole = file_of(name);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const absl::Status status = verdict_on(whole.substr(0, size));
      // What follows the numbers of a text or of XML is not needed.
      const bool may_end_early = name.ends_with(".vti") || name.starts_with("text") ||
                                 name.starts_with("gz") || name.starts_with("zlib");
      EXPECT_TRUE(!status.ok() || (may_end_early && size + 120 > whole.size()))
          << name << " " << size;
    }
  }
}

TEST(HostileImage, IsRefusedOrReadWhateverItsBytesAre) {
  std::mt19937 random(11);
  for (const auto& [name, verdict] : manifest()) {
    const std::string whole = file_of(name);
    for (int trial = 0; trial < 200; ++trial) {
      std::string changed = whole;
      for (std::uint32_t i = 0; i < 1 + random() % 4 && !changed.empty(); ++i) {
        changed[random() % changed.size()] = static_cast<char>(random());
      }
      const ByteSource source = source_of(changed);
      const auto outline = outline_image(source);
      if (!outline.ok() || outline->reading_bytes(changed.size()) > (1U << 26)) continue;
      const auto volume = load_image(source, "", ImageUse::kSurface);
      const auto labels = load_labels(source, "");
      EXPECT_TRUE(volume.ok() || !volume.status().message().empty());
      EXPECT_TRUE(labels.ok() || !labels.status().message().empty());
    }
  }
}

/// VTK's image data with an array of 0 to 7 at 2 x 2 x 2 points, and one of 9 at their cell.
std::string vti_with(const std::string& at_points, const std::string& at_cells) {
  const auto array = [](const std::string& name, const char* values) {
    return "<DataArray type=\"Int16\" format=\"ascii\" Name=\"" + name + "\">" + values +
           "</DataArray>";
  };
  return "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData WholeExtent="
         "\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 1 0 1 0 1\">"
         "<PointData>" +
         array(at_points, "0 1 2 3 4 5 6 7") + "</PointData><CellData>" + array(at_cells, "9") +
         "</CellData></Piece></ImageData></VTKFile>";
}

std::vector<std::string> listed_names(const std::string& bytes) {
  const auto listed = list_image(source_of(bytes));
  EXPECT_TRUE(listed.ok()) << listed.status();
  std::vector<std::string> names;
  for (const GridInfo& info : listed.ok() ? *listed : std::vector<GridInfo>()) {
    names.push_back(info.name);
  }
  return names;
}

TEST(VtiNames, TellPointsAndCellsOfOneNameApart) {
  const std::string bytes = vti_with("a", "a");
  EXPECT_THAT(listed_names(bytes), ElementsAre("a", "a[cells]"));
  const auto cells = load_image(source_of(bytes), "a[cells]", ImageUse::kField);
  ASSERT_TRUE(cells.ok()) << cells.status();
  EXPECT_EQ(cells->transform.to_world({0, 0, 0}), (WorldPoint{0.5, 0.5, 0.5}));
  const auto points = load_image(source_of(bytes), "a", ImageUse::kField);
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->transform.to_world({0, 0, 0}), (WorldPoint{0, 0, 0}));
}

TEST(VtiNames, AreUtf8) {
  EXPECT_THAT(listed_names(vti_with("f\xfcr", "f\xc3\xbcr")),
              ElementsAre("f\xc3\xbcr", "f\xc3\xbcr[cells]"));
}

TEST(VtiNames, AreToldOfArraysWithoutData) {
  std::string bytes = vti_with("density", "mass");
  const std::string filled = "Name=\"density\">0 1 2 3 4 5 6 7</DataArray>";
  bytes.replace(bytes.find(filled), filled.size(), "Name=\"density\"/>");
  const auto listed = list_image(source_of(bytes));
  EXPECT_THAT(std::string(listed.status().message()), HasSubstr("'density' has no data"));
}

/// A file of gzip that begins with these bytes as they are, and ends with a length.
std::string packed_file(const std::string& begin, std::size_t bytes, std::uint32_t length) {
  std::string file("\x1f\x8b\x08\0\0\0\0\0\0\xff\0", 11);
  const auto append = [&](std::uint64_t number, int count) {
    for (int i = 0; i < count; ++i) file += static_cast<char>(number >> 8 * i & 255);
  };
  append(begin.size(), 2);
  append(~begin.size(), 2);
  file += begin;
  file.resize(bytes - 4);
  append(length, 4);
  return file;
}

/// The header of a NIfTI image of as many voxels of two bytes.
std::string header_of(std::int16_t x, std::int16_t y, std::int16_t z) {
  std::string header = file_of("good.nii").substr(0, 352);
  header.resize(600);
  const std::array<std::int16_t, 3> size{x, y, z};
  std::memcpy(header.data() + 42, size.data(), sizeof(size));
  return header;
}

TEST(PackedImage, MayBeLongerThanGzipCanSay) {
  // 6 GB, of which gzip stores 1.7.
  const std::uint64_t length = 352 + 2 * 1000ULL * 1000 * 3000;
  const auto stored = static_cast<std::uint32_t>(length);
  const std::string file = packed_file(header_of(1000, 1000, 3000), 100'000'000, stored);
  const auto listed = list_image(source_of(file));
  ASSERT_TRUE(listed.ok()) << listed.status();
  EXPECT_EQ(listed->front().active_voxels, 3'000'000'000U);
  const auto outline = outline_image(source_of(file));
  ASSERT_TRUE(outline.ok());
  EXPECT_GT(outline->most_reading_bytes(file.size()), 2 * length);
  const std::string other = packed_file(header_of(1000, 1000, 3000), 100'000'000, stored + 1);
  EXPECT_FALSE(list_image(source_of(other)).ok());
  const std::string small = packed_file(header_of(1000, 1000, 3000), 5'000'000, stored);
  EXPECT_THAT(std::string(list_image(source_of(small)).status().message()),
              HasSubstr("it is truncated"));
}

TEST(PackedImage, IsChargedForAllMembersWhateverTheLastClaims) {
  // 2 GB in 60 MB, of which the last member has 100 MB.
  const std::string file = packed_file(header_of(1000, 1000, 1000), 60'000'000, 100'000'000);
  const auto outline = outline_image(source_of(file));
  ASSERT_TRUE(outline.ok()) << outline.status();
  EXPECT_GT(outline->most_reading_bytes(file.size()), 4'000'000'000U);
  EXPECT_GT(outline->most_volume_bytes(file.size()), 4'000'000'000U);
}

TEST(PackedImage, IsRefusedWithNumbersWhereItIsLongerThanItsEndClaims) {
  // 6 GB, of which gzip stores 1.7.
  const auto stored = static_cast<std::uint32_t>(352 + 2 * 1000ULL * 1000 * 3000);
  const std::string file = packed_file(header_of(1000, 1000, 3000), 100'000'000, stored);
  constexpr std::uint64_t kMost = 13'000'000'000;  // more than what it claims would take
  const auto outline = outline_image(source_of(file));
  ASSERT_TRUE(outline.ok()) << outline.status();
  ASSERT_LT(outline->reading_bytes(file.size()), kMost);
  for (const absl::Status& status :
       {load_image(source_of(file), "", ImageUse::kField, kMost).status(),
        load_labels(source_of(file), "", kMost).status()}) {
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("13000000000 is the most"));
  }
}

TEST(PackedImage, IsChargedForWholeBricksOfFewSlices) {
  for (const std::int16_t slices : std::array<std::int16_t, 3>{1, 2, 8}) {
    const std::string header = header_of(2048, 2048, slices);
    const std::uint64_t length = 352 + 2ULL * 2048 * 2048 * slices;
    std::string image = header.substr(0, 352);
    image.resize(length);
    const auto plain = outline_image(source_of(image));
    ASSERT_TRUE(plain.ok()) << plain.status();
    const auto packed = outline_image(
        source_of(packed_file(header, length / 4, static_cast<std::uint32_t>(length))));
    ASSERT_TRUE(packed.ok()) << packed.status();
    EXPECT_GE(packed->most_volume_bytes(length / 4), plain->volume_bytes()) << slices;
    EXPECT_GE(packed->most_reading_bytes(length / 4), plain->reading_bytes(length)) << slices;
  }
}

TEST(LoadImage, HasTheValuesOfItsVoxelsAndItsLeastBeyondThem) {
  const std::string bytes = file_of("good.nrrd");
  const auto volume = load_image(source_of(bytes), "image", ImageUse::kField);
  ASSERT_TRUE(volume.ok()) << volume.status();
  ASSERT_EQ(volume->bricks.size(), 1U);
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) {
        const bool within = x < 4 && y < 3 && z < 2;
        const float expected = within ? static_cast<float>((x * 3 + y) * 2 + z - 7) : -7.0F;
        EXPECT_EQ(volume->values[static_cast<std::size_t>((x * 8 + y) * 8 + z)],
                  within ? expected : volume->background);
      }
    }
  }
  EXPECT_EQ(volume->transform.voxel_size, 0.5);
  const WorldPoint last = volume->transform.to_world({3, 2, 1});
  EXPECT_EQ(last.x, 4.5);
  EXPECT_EQ(last.y, -3);
  EXPECT_EQ(last.z, 6.5);
}

TEST(LoadImage, ReadsEveryFormatAlike) {
  const auto first = load_image(source_of(file_of("good.nrrd")), "", ImageUse::kSurface);
  ASSERT_TRUE(first.ok());
  for (const std::string name :
       {"good.nii", "good.mha", "good.vti", "blocks.vti", "good.nii.gz", "gz.nrrd", "big.nii",
        "zlib.mha", "text.nrrd"}) {
    const std::string bytes = file_of(name);
    const auto volume = load_image(source_of(bytes), "", ImageUse::kSurface);
    ASSERT_TRUE(volume.ok()) << name << ": " << volume.status();
    EXPECT_EQ(volume->values, first->values) << name;
    EXPECT_EQ(volume->transform.linear, first->transform.linear) << name;
    EXPECT_EQ(volume->transform.translation, first->transform.translation) << name;
  }
}

TEST(LoadLabels, NumbersWholeValues) {
  const std::string bytes = file_of("good.nii");
  const auto labels = load_labels(source_of(bytes), "");
  ASSERT_TRUE(labels.ok()) << labels.status();
  EXPECT_EQ(labels->labels.size(), 24U);
  EXPECT_EQ(labels->labels[labels->at({1, 2, 1})], (1 * 3 + 2) * 2 + 1 - 7);
}

}  // namespace
}  // namespace tet
