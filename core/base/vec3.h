// Vectors of three: with named parts where arithmetic is done, or as an array where axes are
// counted.
#pragma once

#include <array>

namespace tet {

template <class Real>
struct BasicVector {
  Real x, y, z;
};
using Vector = BasicVector<double>;

template <class Real>
BasicVector<Real> operator-(const BasicVector<Real>& u, const BasicVector<Real>& v) noexcept {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}

template <class Real>
BasicVector<Real> cross(const BasicVector<Real>& u, const BasicVector<Real>& v) noexcept {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

template <class Real>
Real dot(const BasicVector<Real>& u, const BasicVector<Real>& v) noexcept {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

/// Widens to double, for products that leave the range of a float.
inline Vector widened(const BasicVector<float>& v) noexcept { return {v.x, v.y, v.z}; }

/// A vector by axis.
using Triple = std::array<double, 3>;

inline double dot(const Triple& a, const Triple& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Triple difference(const Triple& a, const Triple& b) noexcept {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

}  // namespace tet
