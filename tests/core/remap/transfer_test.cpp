#include "core/remap/transfer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "tests/core/remap/boxes_of_tets.h"

namespace tet {
namespace {

using test::at_cells;
using test::at_points;
using test::box_of_tets;

double linear(const WorldPoint& p) { return 3 + 2 * p.x - p.y + 0.5 * p.z; }
double wave(const WorldPoint& p) {
  return std::sin(3 * p.x) * std::cos(2 * p.y) + std::exp(-p.z);
}
double step(const WorldPoint& p) { return p.x + p.y > 1 ? 5 : 1; }

TransferResult transferred(const DataMesh& from,
                           const DataMesh& to,
                           const TransferOptions& options = {},
                           int threads = 2) {
  absl::StatusOr<TransferResult> result = absl::UnknownError("not transferred");
  TaskPool(threads).run([&] { result = transfer(from, to, options); });
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *result : TransferResult{};
}

double farthest_from(const DataMesh& mesh,
                     const DataArray& array,
                     double (*exact)(const WorldPoint&)) {
  double farthest = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    farthest = std::max(farthest, std::abs(array.values[i] - exact(mesh.points[i])));
  }
  return farthest;
}

DataMesh waves(bool turned = false) {
  DataMesh mesh = box_of_tets(9, 1, 0.2, {}, turned);
  mesh.point_data = {at_points(mesh, "linear", linear), at_points(mesh, "wave", wave),
                     at_points(mesh, "step", step)};
  mesh.cell_data = {at_cells(mesh, "density", wave), at_cells(mesh, "label", step)};
  return mesh;
}

constexpr TransferOptions kConserve{.mode = TransferMode::kConservative};

TEST(Transfer, KeepsWhatIsLinear) {
  for (const bool turned : {false, true}) {
    const DataMesh from = waves(turned), to = box_of_tets(13, 1, 0.22);
    const TransferResult result = transferred(from, to);
    EXPECT_LT(farthest_from(to, result.point_data[0], linear), 1e-12);
    EXPECT_LT(farthest_from(to, result.point_data[1], wave), 0.03);
    EXPECT_EQ(result.outside_points, 0U);
  }
}

TEST(Transfer, CarriesWhatIsLinearOnBeyondTheOldMesh) {
  const DataMesh from = waves(), to = box_of_tets(8, 1.1, 0.2, {-0.05, -0.05, -0.05});
  const TransferResult result = transferred(from, to);
  EXPECT_GT(result.outside_points, 300U);
  EXPECT_NEAR(result.farthest, 0.05 * std::sqrt(3), 1e-9);
  EXPECT_LT(farthest_from(to, result.point_data[0], linear), 1e-12);
}

TEST(Transfer, TakesTheNearestCornerFarAway) {
  const DataMesh from = waves(), to = box_of_tets(2, 1, 0, {50, 0, 0});
  const TransferResult result = transferred(from, to);
  for (const double value : result.point_data[0].values) {
    EXPECT_GE(value, 2);
    EXPECT_LE(value, 5.5);
  }
  EXPECT_NEAR(result.farthest, 50, 1e-9);
}

TEST(Transfer, ClampsToTheTetThatAValueComesFrom) {
  const DataMesh from = waves(), to = box_of_tets(8, 1.2, 0.2, {-0.1, -0.1, -0.1});
  const TransferResult free = transferred(from, to);
  const TransferResult clamped = transferred(from, to, {.clamp = true});
  EXPECT_GT(*std::ranges::max_element(free.point_data[0].values), 5.6);
  EXPECT_LE(*std::ranges::max_element(clamped.point_data[0].values), 5.5);
  EXPECT_GE(*std::ranges::min_element(clamped.point_data[0].values), 2);
}

TEST(Transfer, GivesACellTheValueOfTheCellAroundItsMiddle) {
  const DataMesh from = waves(), to = box_of_tets(13, 1, 0.22);
  const TransferResult result = transferred(from, to);
  const DataArray exact = at_cells(to, "label", step);
  std::size_t same = 0;
  for (std::size_t i = 0; i < exact.values.size(); ++i) {
    const double value = result.cell_data[1].values[i];
    EXPECT_TRUE(value == 1 || value == 5);
    same += value == exact.values[i] ? 1 : 0;
  }
  EXPECT_GT(same, exact.values.size() * 9 / 10);
}

TEST(Transfer, KeepsTheTypeOfLabels) {
  DataMesh from = waves();
  from.cell_data[1].type = NumberType::kUint8;
  const DataMesh to = box_of_tets(4, 1);
  EXPECT_EQ(transferred(from, to).cell_data[1].type, NumberType::kUint8);
  EXPECT_EQ(transferred(from, to, kConserve).cell_data[1].type, NumberType::kFloat64);
}

void expect_same_integrals(const TransferResult& result) {
  ASSERT_EQ(result.told.size(), 5U);
  for (const TransferredArray& array : result.told) {
    EXPECT_NEAR(array.new_integral, array.old_integral, 1e-10 * std::abs(array.old_integral))
        << array.name;
  }
}

TEST(Transfer, ConservesIntegrals) {
  for (const bool clamp : {false, true}) {
    for (const bool turned : {false, true}) {
      const DataMesh from = waves(turned), to = box_of_tets(13, 1, 0.22, {}, turned);
      TransferOptions options = kConserve;
      options.clamp = clamp;
      expect_same_integrals(transferred(from, to, options));
    }
  }
}

TEST(Transfer, ConservesIntegralsWhereTheMeshesEndElsewhere) {
  const DataMesh from = waves();
  expect_same_integrals(
      transferred(from, box_of_tets(8, 1.1, 0.2, {-0.05, -0.05, -0.05}), kConserve));
  expect_same_integrals(
      transferred(from, box_of_tets(8, 0.9, 0.2, {0.05, 0.05, 0.05}), kConserve));
}

TEST(Transfer, ThatConservesKeepsWhatIsLinearToo) {
  const DataMesh from = waves(), to = box_of_tets(7, 1, 0.22);
  const TransferResult result = transferred(from, to, kConserve);
  EXPECT_LT(farthest_from(to, result.point_data[0], linear), 1e-10);
  EXPECT_LT(farthest_from(to, result.point_data[1], wave), 0.06);
}

TEST(Transfer, ThatConservesGivesACellTheMeanOfWhatItCovers) {
  DataMesh from = box_of_tets(8, 1);
  from.cell_data = {
      at_cells(from, "label", [](const WorldPoint& p) { return p.x < 0.5 ? 2.0 : 6.0; })};
  const DataMesh to = box_of_tets(1, 1);
  const TransferResult result = transferred(from, to, kConserve);
  double sum = 0;
  for (const double value : result.cell_data[0].values) {
    EXPECT_GE(value, 2);
    EXPECT_LE(value, 6);
    sum += value / 6;
  }
  EXPECT_NEAR(sum, 4, 1e-12);
}

TEST(Transfer, ThatConservesAndClampsStaysBetweenTheOldValues) {
  const DataMesh from = waves(), to = box_of_tets(13, 1, 0.22);
  TransferOptions options = kConserve;
  const DataArray free = transferred(from, to, options).point_data[2];
  options.clamp = true;
  const DataArray clamped = transferred(from, to, options).point_data[2];
  EXPECT_GT(*std::ranges::max_element(free.values), 5.001) << "least squares overshoot";
  EXPECT_LE(*std::ranges::max_element(clamped.values), 5);
  EXPECT_GE(*std::ranges::min_element(clamped.values), 1);
}

TEST(Transfer, TakesOnlyArraysThatAreAskedFor) {
  const DataMesh from = waves(), to = box_of_tets(3, 1);
  const TransferResult result = transferred(from, to, {.arrays = {"density", "wave"}});
  ASSERT_EQ(result.point_data.size(), 1U);
  ASSERT_EQ(result.cell_data.size(), 1U);
  EXPECT_EQ(result.point_data[0].name, "wave");
  EXPECT_EQ(result.cell_data[0].name, "density");
}

TEST(Transfer, TakesVectors) {
  DataMesh from = box_of_tets(5, 1, 0.2);
  DataArray velocity{.name = "velocity", .components = 3, .values = {}};
  for (const WorldPoint& p : from.points) {
    velocity.values.insert(velocity.values.end(), {p.x, 2 * p.y, 1 - p.z});
  }
  from.point_data = {velocity};
  const DataMesh to = box_of_tets(4, 1, 0.22);
  for (const TransferOptions& options : {TransferOptions{}, kConserve}) {
    const DataArray found = transferred(from, to, options).point_data[0];
    ASSERT_EQ(found.components, 3U);
    for (std::size_t i = 0; i < to.points.size(); ++i) {
      EXPECT_NEAR(found.values[3 * i + 1], 2 * to.points[i].y, 1e-9);
      EXPECT_NEAR(found.values[3 * i + 2], 1 - to.points[i].z, 1e-9);
    }
  }
}

TEST(Transfer, IsTheSameForAnyNumberOfThreads) {
  const DataMesh from = waves(), to = box_of_tets(13, 1.05, 0.22);
  for (const TransferOptions& options : {TransferOptions{}, kConserve}) {
    const TransferResult one = transferred(from, to, options, 1);
    const TransferResult many = transferred(from, to, options, 7);
    for (std::size_t i = 0; i < one.point_data.size(); ++i) {
      EXPECT_EQ(one.point_data[i].values, many.point_data[i].values);
    }
    EXPECT_EQ(one.cell_data[0].values, many.cell_data[0].values);
  }
}

TEST(Transfer, TakesMeshesWithFlatTetsAndUnusedPoints) {
  DataMesh from = waves();
  from.tets.push_back({0, 1, 2, 2});
  for (DataArray& array : from.cell_data) array.values.push_back(1);
  from.points.push_back({9, 9, 9});
  for (DataArray& array : from.point_data) array.values.push_back(1e3);
  DataMesh to = box_of_tets(4, 1, 0.2);
  to.tets.push_back({0, 0, 0, 0});
  to.points.push_back({0.5, 0.5, 0.5});
  for (const TransferOptions& options : {TransferOptions{}, kConserve}) {
    const TransferResult result = transferred(from, to, options);
    for (const double value : result.point_data[1].values) EXPECT_TRUE(std::isfinite(value));
    for (const double value : result.cell_data[0].values) EXPECT_TRUE(std::isfinite(value));
  }
}

/// Two tets that are flat but for rounding, of four points of their own: a tilted
/// parallelogram, and one that has a corner twice.
void add_flat_tets(DataMesh& mesh, std::mt19937& random) {
  std::uniform_real_distribution<double> place(0.05, 0.45);
  const auto at = [&] { return WorldPoint{place(random), place(random), place(random)}; };
  const WorldPoint a = at(), b = at(), c = at();
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), {a,
                                         {a.x + b.x, a.y + b.y, a.z + b.z},
                                         {a.x + c.x, a.y + c.y, a.z + c.z},
                                         {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z}});
  mesh.tets.push_back({first, first + 1, first + 2, first + 3});
  mesh.tets.push_back({first, first, first + 1, first + 2});
}

void expect_near(const std::vector<double>& values, const std::vector<double>& wanted) {
  ASSERT_GE(values.size(), wanted.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_TRUE(std::isfinite(values[i])) << "row " << i;
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ASSERT_NEAR(values[i], wanted[i], 1e-9) << "row " << i;
  }
}

TEST(Transfer, IsTheSameBesideTetsOfTheNewMeshThatAreFlatButForRounding) {
  const DataMesh from = waves();
  DataMesh to = box_of_tets(4, 1, 0.2);
  const TransferResult without = transferred(from, to, kConserve);
  std::mt19937 random(3);
  for (int i = 0; i < 30; ++i) add_flat_tets(to, random);
  const TransferResult with = transferred(from, to, kConserve);
  for (std::size_t k = 0; k < without.point_data.size(); ++k) {
    expect_near(with.point_data[k].values, without.point_data[k].values);
  }
  for (std::size_t k = 0; k < without.cell_data.size(); ++k) {
    expect_near(with.cell_data[k].values, without.cell_data[k].values);
  }
}

TEST(Transfer, IsTheSameBesideTetsOfTheOldMeshThatAreFlatButForRounding) {
  DataMesh from = waves();
  const DataMesh to = box_of_tets(4, 1, 0.2);
  const TransferResult without = transferred(from, to, kConserve);
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) add_flat_tets(from, random);
  for (DataArray& array : from.point_data) array.values.resize(from.points.size(), 7);
  for (DataArray& array : from.cell_data) array.values.resize(from.tets.size(), 7);
  const TransferResult with = transferred(from, to, kConserve);
  for (std::size_t k = 0; k < without.point_data.size(); ++k) {
    expect_near(with.point_data[k].values, without.point_data[k].values);
  }
  for (std::size_t k = 0; k < without.cell_data.size(); ++k) {
    expect_near(with.cell_data[k].values, without.cell_data[k].values);
  }
}

/// One tet at the origin with these values at its corners.
DataMesh lone_tet(const std::vector<WorldPoint>& corners) {
  DataMesh mesh;
  mesh.points = corners;
  mesh.tets = {{0, 1, 2, 3}};
  mesh.point_data = {{.name = "corner", .values = {10, 20, 30, 40}}};
  return mesh;
}

TEST(Transfer, TakesTheCornerThatIsNearestAndNotTheOneOfTheLargestShare) {
  const DataMesh from = lone_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  DataMesh to = box_of_tets(1, 1);
  to.points[0] = {1.5, 0.2, -4};  // whose shares are 3.3, 1.5, 0.2, -4
  EXPECT_EQ(transferred(from, to).point_data[0].values[0], 20);
}

TEST(Transfer, DoesNotCarryOnWhatATetSaysThatIsFlatButForRounding) {
  const DataMesh from = lone_tet({{0, 0, 0}, {1, 0, 1e-15}, {0, 1, 0}, {1, 1, 0}});
  DataMesh to = box_of_tets(1, 1);
  to.points[0] = {0.9, 0.1, 0.3};
  EXPECT_EQ(transferred(from, to).point_data[0].values[0], 20);
}

TEST(Transfer, ThatConservesTakesNumbersOfAnySize) {
  constexpr int kPower = 498;  // about 1e150, the largest that a file may have
  for (const double size : {1e4, 1e-9}) {
    DataMesh from = box_of_tets(5, size, 0.2);
    from.point_data = {at_points(from, "wave", [&](const WorldPoint& p) {
      return wave({p.x / size, p.y / size, p.z / size});
    })};
    const DataMesh to = box_of_tets(4, size, 0.2);
    const std::vector<double> plain = transferred(from, to, kConserve).point_data[0].values;
    EXPECT_GT(*std::ranges::max_element(plain), 1);
    for (const int power : {kPower, -kPower}) {
      DataMesh scaled = from;
      for (double& value : scaled.point_data[0].values) value = std::ldexp(value, power);
      std::vector<double> wanted = plain;
      for (double& value : wanted) value = std::ldexp(value, power);
      EXPECT_EQ(transferred(scaled, to, kConserve).point_data[0].values, wanted)
          << "size " << size << ", power " << power;
    }
  }
}

std::size_t looks_of(const DataMesh& from, const DataMesh& to, const TransferOptions& options) {
  std::atomic<std::size_t> looks = 0;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(), [&] {
    ++looks;
    return false;
  });
  TaskPool(2).run([&] { EXPECT_TRUE(transfer(from, to, options, cancellation).ok()); });
  return looks;
}

TEST(Transfer, LooksWhetherItIsToStopEveryFewPoints) {
  const DataMesh to = box_of_tets(13, 1, 0.22);
  EXPECT_GE(looks_of(waves(), to, {}), (to.points.size() + to.tets.size()) / 16);
}

TEST(Transfer, LooksWhetherItIsToStopWithinATetThatCoversTheOldMesh) {
  DataMesh from = box_of_tets(40, 1);
  from.cell_data = {at_cells(from, "density", wave)};
  DataMesh to = box_of_tets(1, 1);
  to.tets = {{0, 1, 2, 4}};
  EXPECT_GE(looks_of(from, to, kConserve), from.tets.size() / 1024);
}

TEST(Transfer, RefusesWhatCannotBe) {
  const DataMesh from = waves(), to = box_of_tets(2, 1);
  const auto code_of = [](const auto& result) { return result.status().code(); };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_EQ(code_of(transfer({}, to, {})), kInvalid);
  EXPECT_EQ(code_of(transfer(from, {}, {})), kInvalid);
  EXPECT_EQ(code_of(transfer(to, from, {})), kInvalid) << "it has no arrays";
  EXPECT_EQ(code_of(transfer(from, to, {.arrays = {"heat"}})), kInvalid);
  EXPECT_EQ(code_of(transfer(from, box_of_tets(2, 1, 0, {7, 0, 0}), kConserve)), kInvalid);
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(code_of(transfer(from, to, {}, cancelled)), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace tet
