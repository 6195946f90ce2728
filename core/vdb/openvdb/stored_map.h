// A transform for writing: voxels of any size, at any place.
#pragma once

#include <istream>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>

#include <openvdb/math/Maps.h>

namespace tet {

/// A uniform scale and a translation as a file has them.
///
/// OpenVDB reads, writes and applies maps of small voxels, but makes none with a determinant
/// below 3e-15; and whenever it copies the transform of a grid, as it does to write it, it
/// makes a matrix of each map that says it is linear. So this one has all numbers as a file
/// would have them, and says that it is not linear. What is read back is an ordinary map.
class StoredMap final : public openvdb::math::MapBase {
 public:
  using Vec3d = openvdb::Vec3d;
  using Mat3d = openvdb::Mat3d;
  using Axis = openvdb::math::Axis;

  StoredMap(double scale, const Vec3d& translation) {
    const double inverse = 1 / scale;
    std::stringstream stored;
    for (const Vec3d& triple : {translation, Vec3d(scale), Vec3d(scale), Vec3d(inverse),
                                Vec3d(inverse * inverse), Vec3d(0.5 * inverse)}) {
      triple.write(stored);
    }
    map_.read(stored);
  }

  // OpenVDB's names.
  std::shared_ptr<openvdb::math::AffineMap> getAffineMap() const override {
    return map_.getAffineMap();
  }
  openvdb::Name type() const override { return map_.type(); }
  bool isEqual(const MapBase& other) const override { return map_.isEqual(other); }
  bool isLinear() const override { return false; }
  bool hasUniformScale() const override { return true; }
  Vec3d applyMap(const Vec3d& in) const override { return map_.applyMap(in); }
  Vec3d applyInverseMap(const Vec3d& in) const override { return map_.applyInverseMap(in); }
  Vec3d applyIJT(const Vec3d& in) const override { return map_.applyIJT(in); }
  Vec3d applyIJT(const Vec3d& in, const Vec3d&) const override { return map_.applyIJT(in); }
  Mat3d applyIJC(const Mat3d& in) const override { return map_.applyIJC(in); }
  Mat3d applyIJC(const Mat3d& in, const Vec3d&, const Vec3d&) const override {
    return map_.applyIJC(in);
  }
  double determinant() const override { return map_.determinant(); }
  double determinant(const Vec3d&) const override { return map_.determinant(); }
  Vec3d voxelSize() const override { return map_.voxelSize(); }
  Vec3d voxelSize(const Vec3d&) const override { return map_.voxelSize(); }
  void read(std::istream& stream) override { map_.read(stream); }
  void write(std::ostream& stream) const override { map_.write(stream); }
  std::string str() const override { return map_.str(); }
  Ptr copy() const override { return std::make_shared<StoredMap>(*this); }
  Ptr preRotate(double radians, Axis axis) const override {
    return map_.preRotate(radians, axis);
  }
  Ptr preTranslate(const Vec3d& by) const override { return map_.preTranslate(by); }
  Ptr preScale(const Vec3d& by) const override { return map_.preScale(by); }
  Ptr preShear(double shear, Axis a, Axis b) const override {
    return map_.preShear(shear, a, b);
  }
  Ptr postRotate(double radians, Axis axis) const override {
    return map_.postRotate(radians, axis);
  }
  Ptr postTranslate(const Vec3d& by) const override { return map_.postTranslate(by); }
  Ptr postScale(const Vec3d& by) const override { return map_.postScale(by); }
  Ptr postShear(double shear, Axis a, Axis b) const override {
    return map_.postShear(shear, a, b);
  }
  Vec3d applyJacobian(const Vec3d& in) const override { return map_.applyJacobian(in); }
  Vec3d applyJacobian(const Vec3d& in, const Vec3d&) const override {
    return map_.applyJacobian(in);
  }
  Vec3d applyInverseJacobian(const Vec3d& in) const override {
    return map_.applyInverseJacobian(in);
  }
  Vec3d applyInverseJacobian(const Vec3d& in, const Vec3d&) const override {
    return map_.applyInverseJacobian(in);
  }
  Vec3d applyJT(const Vec3d& in) const override { return map_.applyJT(in); }
  Vec3d applyJT(const Vec3d& in, const Vec3d&) const override { return map_.applyJT(in); }
  Ptr inverseMap() const override { return map_.inverseMap(); }

 private:
  openvdb::math::UniformScaleTranslateMap map_;
};

}  // namespace tet
