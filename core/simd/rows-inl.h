/// Rows of four floats of sixteen bodies <-> four vectors of one component each. Included once per vector target, see targets.h.
///
/// A vector of N lanes is made of N/4 blocks; the row of lane 4 b + k is loaded into block b of vector k, and the four vectors are
/// transposed within their blocks. Whole rows are read and written, which is twice as fast as gathers and scatters.
// NOLINTNEXTLINE: the guard toggles, as Highway wants it
#if defined(DRUMSWEEP_SIMD_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUMSWEEP_SIMD_ROWS_INL_H
#undef DRUMSWEEP_SIMD_ROWS_INL_H
#else
#define DRUMSWEEP_SIMD_ROWS_INL_H
#endif

#include "core/simd/targets.h"
// After the choice of targets.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Up to the sixteen lanes of a pack.
using FloatTag = hn::CappedTag<float, 16>;
using FloatV = hn::Vec<FloatTag>;
using MaskV = hn::Mask<FloatTag>;
constexpr std::size_t simd_lanes = hn::MaxLanes(FloatTag());

/// Bit per lane.
HWY_INLINE std::uint32_t BitsOf(MaskV mask) {
  std::uint8_t bytes[8] = {0};
  hn::StoreMaskBits(FloatTag(), mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}

/// One number per lane, with the operators that physics is written in.
struct RealV {
  FloatV v;
  HWY_INLINE explicit RealV(FloatV lanes) : v(lanes) {}
  HWY_INLINE explicit RealV(double x) : v(hn::Set(FloatTag(), static_cast<float>(x))) {}
};
HWY_INLINE RealV operator+(RealV a, RealV b) { return RealV(hn::Add(a.v, b.v)); }
HWY_INLINE RealV operator-(RealV a, RealV b) { return RealV(hn::Sub(a.v, b.v)); }
HWY_INLINE RealV operator*(RealV a, RealV b) { return RealV(hn::Mul(a.v, b.v)); }
HWY_INLINE RealV operator/(RealV a, RealV b) { return RealV(hn::Div(a.v, b.v)); }
HWY_INLINE MaskV operator<(RealV a, RealV b) { return hn::Lt(a.v, b.v); }
HWY_INLINE RealV square_root(RealV a) { return RealV(hn::Sqrt(a.v)); }
HWY_INLINE RealV select(MaskV mask, RealV yes, RealV no) { return RealV(hn::IfThenElse(mask, yes.v, no.v)); }

/// Three components per lane.
struct Vector3V {
  FloatV x, y, z;
};
HWY_INLINE Vector3V operator+(Vector3V a, Vector3V b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector3V operator-(Vector3V a, Vector3V b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector3V operator*(Vector3V a, FloatV s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }
HWY_INLINE FloatV Dot(Vector3V a, Vector3V b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector3V Cross(Vector3V a, Vector3V b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector3V Select(MaskV mask, Vector3V yes, Vector3V no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

/// @param components  three arrays of sixteen
template <class Components>
HWY_INLINE Vector3V Load3(const Components& components, std::size_t lane) {
  const FloatTag d;
  return {hn::Load(d, components[0] + lane), hn::Load(d, components[1] + lane), hn::Load(d, components[2] + lane)};
}
template <class Components>
HWY_INLINE void Store3(Vector3V v, Components& components, std::size_t lane) {
  const FloatTag d;
  hn::Store(v.x, d, components[0] + lane);
  hn::Store(v.y, d, components[1] + lane);
  hn::Store(v.z, d, components[2] + lane);
}

struct Vector4V {
  FloatV x, y, z, w;
};

#if HWY_TARGET == HWY_SCALAR

/// @param index  (lanes) rows; @param stride  floats from row to row
HWY_INLINE Vector4V LoadRows(const float* base, std::size_t stride, const std::uint32_t* index) {
  const FloatTag d;
  const float* row = base + stride * index[0];
  return {hn::Set(d, row[0]), hn::Set(d, row[1]), hn::Set(d, row[2]), hn::Set(d, row[3])};
}
HWY_INLINE void StoreRows(const Vector4V& v, float* base, std::size_t stride, const std::uint32_t* index) {
  float* row = base + stride * index[0];
  row[0] = hn::GetLane(v.x);
  row[1] = hn::GetLane(v.y);
  row[2] = hn::GetLane(v.z);
  row[3] = hn::GetLane(v.w);
}

#else

/// Block b holds the four floats at base + stride * index[4 b].
template <class D>
HWY_INLINE hn::Vec<D> LoadBlocks(D d, const float* HWY_RESTRICT base, std::size_t stride,
                                 const std::uint32_t* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, base + stride * index[0]);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadBlocks(half, base, stride, index + hn::MaxLanes(D()) / 2),
                       LoadBlocks(half, base, stride, index));
  }
}

template <class D>
HWY_INLINE void StoreBlocks(D d, hn::Vec<D> v, float* HWY_RESTRICT base, std::size_t stride,
                            const std::uint32_t* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    hn::StoreU(v, d, base + stride * index[0]);
  } else {
    const hn::Half<D> half;
    StoreBlocks(half, hn::LowerHalf(half, v), base, stride, index);
    StoreBlocks(half, hn::UpperHalf(half, v), base, stride, index + hn::MaxLanes(D()) / 2);
  }
}

HWY_INLINE Vector4V LoadRows(const float* HWY_RESTRICT base, std::size_t stride,
                             const std::uint32_t* HWY_RESTRICT index) {
  const FloatTag d;
  const hn::Repartition<double, FloatTag> d64;
  const FloatV r0 = LoadBlocks(d, base, stride, index), r1 = LoadBlocks(d, base, stride, index + 1),
               r2 = LoadBlocks(d, base, stride, index + 2), r3 = LoadBlocks(d, base, stride, index + 3);
  const auto low01 = hn::BitCast(d64, hn::InterleaveLower(d, r0, r1)),
             high01 = hn::BitCast(d64, hn::InterleaveUpper(d, r0, r1)),
             low23 = hn::BitCast(d64, hn::InterleaveLower(d, r2, r3)),
             high23 = hn::BitCast(d64, hn::InterleaveUpper(d, r2, r3));
  return {hn::BitCast(d, hn::InterleaveLower(d64, low01, low23)),
          hn::BitCast(d, hn::InterleaveUpper(d64, low01, low23)),
          hn::BitCast(d, hn::InterleaveLower(d64, high01, high23)),
          hn::BitCast(d, hn::InterleaveUpper(d64, high01, high23))};
}

HWY_INLINE void StoreRows(const Vector4V& v, float* HWY_RESTRICT base, std::size_t stride,
                          const std::uint32_t* HWY_RESTRICT index) {
  const FloatTag d;
  const hn::Repartition<double, FloatTag> d64;
  const auto low_xy = hn::BitCast(d64, hn::InterleaveLower(d, v.x, v.y)),
             high_xy = hn::BitCast(d64, hn::InterleaveUpper(d, v.x, v.y)),
             low_zw = hn::BitCast(d64, hn::InterleaveLower(d, v.z, v.w)),
             high_zw = hn::BitCast(d64, hn::InterleaveUpper(d, v.z, v.w));
  StoreBlocks(d, hn::BitCast(d, hn::InterleaveLower(d64, low_xy, low_zw)), base, stride, index);
  StoreBlocks(d, hn::BitCast(d, hn::InterleaveUpper(d64, low_xy, low_zw)), base, stride, index + 1);
  StoreBlocks(d, hn::BitCast(d, hn::InterleaveLower(d64, high_xy, high_zw)), base, stride, index + 2);
  StoreBlocks(d, hn::BitCast(d, hn::InterleaveUpper(d64, high_xy, high_zw)), base, stride, index + 3);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#endif
