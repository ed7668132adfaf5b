// The loop over boxes, spheres or triangles. Point sets have another one.
//
// A builder reads columns of floats, one value of one object in each lane. If
// the caller's memory has that form, it is read in place. Other layouts, and
// the last objects, are copied through tiles of 64 objects on the stack, so
// that nothing past the last element is read or written.
#if defined(HALFSPACE_KERNELS_FIT_MANY_TILES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_TILES_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_TILES_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_TILES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/cache_control.h"
#include "hwy/highway.h"
#include "kernels/fit_many/kernel_table.h"
#include "kernels/fit_many/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <size_t kColumns>
struct InputTile {
  HWY_ALIGN float values[kColumns][kTileObjects];
  const float* columns[kColumns];  // of `values`, as FitVector() reads them

  InputTile() {
    for (size_t c = 0; c < kColumns; ++c) columns[c] = values[c];
    Clear();
  }

  void Clear() {
    for (size_t c = 0; c < kColumns; ++c) {
      for (size_t i = 0; i < kTileObjects; ++i) values[c][i] = 0.f;
    }
  }

  // Objects begin .. begin + count - 1; the others stay as they are.
  void Read(const kernels::FitJob& job, size_t begin, size_t count) {
    size_t done = 0;
    if (IsPacked(job)) {
      const FitTag d;
      const size_t lanes = hn::Lanes(d);
      const float* from = job.columns.floats(0) + begin * kColumns;
      for (; done + lanes <= count; done += lanes) {
        Deinterleave(d, from + done * kColumns, done);
      }
    }
    for (size_t c = 0; c < kColumns; ++c) {
      const float* from = job.columns.floats(c) + begin * job.columns.stride;
      for (size_t i = done; i < count; ++i)
        values[c][i] = from[i * job.columns.stride];
    }
  }

 private:
  // An array of structures with nothing else in it, such as x y z, x y z.
  static bool IsPacked(const kernels::FitJob& job) {
    bool is_packed = job.columns.stride == kColumns;
    for (size_t c = 1; c < kColumns; ++c) {
      is_packed &= job.columns.floats(c) == job.columns.floats(0) + c;
    }
    return is_packed && kColumns <= 4;
  }

  template <class D>
  HWY_INLINE void Deinterleave(D d, const float* from, size_t i) {
    hn::Vec<D> x;
    hn::Vec<D> y;
    if constexpr (kColumns == 2) {
      hn::LoadInterleaved2(d, from, x, y);
    } else if constexpr (kColumns == 3 || kColumns == 4) {
      hn::Vec<D> z;
      if constexpr (kColumns == 3) {
        hn::LoadInterleaved3(d, from, x, y, z);
      } else {
        hn::Vec<D> w;
        hn::LoadInterleaved4(d, from, x, y, z, w);
        hn::Store(w, d, values[3] + i);
      }
      hn::Store(z, d, values[2] + i);
    }
    if constexpr (kColumns <= 4) {
      hn::Store(x, d, values[0] + i);
      hn::Store(y, d, values[1] + i);
    }
  }
};

template <int kDims>
inline constexpr size_t kFitPlanes = 2 * (kDims + 1);

// Pointers to object `begin` in all wanted planes.
template <int kDims>
struct OutputPlanes {
  float* planes[kFitPlanes<kDims>];

  OutputPlanes(const kernels::FitJob& job, size_t begin) {
    for (size_t p = 0; p < kFitPlanes<kDims>; ++p) {
      planes[p] = job.planes[p] == nullptr ? nullptr : job.planes[p] + begin;
    }
  }

  float* min(size_t axis) const { return planes[axis]; }
  float* max(size_t axis) const { return planes[kDims + 1 + axis]; }
};

// A tile of bounds on the stack. Write() or StreamOut() copies it to the wanted
// planes.
template <int kDims>
struct OutputTile {
  HWY_ALIGN float values[kFitPlanes<kDims>][kTileObjects];
  OutputPlanes<kDims> places;
  OutputPlanes<kDims> wanted;

  OutputTile(const kernels::FitJob& job, size_t begin)
      : places(job, begin), wanted(job, begin) {
    for (size_t p = 0; p < kFitPlanes<kDims>; ++p) {
      if (wanted.planes[p] != nullptr) places.planes[p] = values[p];
    }
  }

  void Write(size_t count) const {
    for (size_t p = 0; p < kFitPlanes<kDims>; ++p) {
      if (wanted.planes[p] == nullptr) continue;
      for (size_t i = 0; i < count; ++i) wanted.planes[p][i] = values[p][i];
    }
  }

  // Copies the whole tile past the caches.
  void StreamOut() const {
    const FitTag d;
    const size_t lanes = hn::Lanes(d);
    for (size_t p = 0; p < kFitPlanes<kDims>; ++p) {
      if (wanted.planes[p] == nullptr) continue;
      for (size_t i = 0; i < kTileObjects; i += lanes) {
        hn::Stream(hn::Load(d, values[p] + i), d, wanted.planes[p] + i);
      }
    }
  }
};

// Whether to write past the caches. An ordinary store first reads the line that
// it writes to. Without these reads, a build out of the caches moves 56 bytes
// an object instead of 88 (boxes to AABOs). But the output is then not in the
// caches: with 32 MiB of L3, ordinary stores were faster up to 64 MiB of
// output.
template <int kDims>
bool ShouldStream(const kernels::FitJob& job) {
#if HWY_ARCH_X86
  constexpr size_t kStreamedBytes = size_t{96} << 20;
  const size_t vector_bytes = hn::Lanes(FitTag()) * sizeof(float);
  size_t bytes = 0;
  for (size_t p = 0; p < kFitPlanes<kDims>; ++p) {
    if (job.planes[p] == nullptr) continue;
    if (reinterpret_cast<uintptr_t>(job.planes[p]) % vector_bytes != 0) {
      return false;
    }
    bytes += job.size * sizeof(float);
  }
  return bytes >= kStreamedBytes;
#else
  (void)job;
  return false;
#endif
}

// Bounds all shapes. A Builder has
//   kColumns       values of one shape
//   kDims
//   Tag            whose lanes are the shapes of one step
//   Read(tile, job, begin, count)   fills an InputTile
//   FitVector<kStore>(tag, columns, planes, i, begin, tally)   bounds shapes i
//                  and on of the columns; `begin` is the number of shape 0
template <class Builder>
class TileWalk {
 public:
  TileWalk(const Builder& builder, const kernels::FitJob& job,
           bool is_read_in_place, kernels::FitTally& tally)
      : builder_(builder),
        job_(job),
        is_read_in_place_(is_read_in_place),
        tally_(tally) {}

  void Run() {
    const size_t whole = job_.size / kTileObjects * kTileObjects;
    if (!ShouldStream<kDims>(job_)) {
      FitWhole<StoreMode::kCached>(whole);
    } else {
      // A line is written in one or two steps, or it is collected in a tile
      // first (measured: 8 open lines written in four steps each are slower
      // than ordinary stores).
      if (hn::Lanes(typename Builder::Tag()) * sizeof(float) >= 32) {
        FitWhole<StoreMode::kPastCaches>(whole);
      } else {
        FitAndStream(whole);
      }
      hwy::FlushStream();
    }
    if (whole != job_.size) FitRest(whole, job_.size - whole);
  }

 private:
  static constexpr int kDims = Builder::kDims;

  template <StoreMode kStore>
  void FitWhole(size_t whole) {
    if (is_read_in_place_) {
      const float* columns[Builder::kColumns] = {};
      ListColumns(columns, 0);
      FitVectors<kStore>(columns, OutputPlanes<kDims>(job_, 0), whole, 0);
      return;
    }
    for (size_t begin = 0; begin < whole; begin += kTileObjects) {
      FitTile<kStore>(begin, OutputPlanes<kDims>(job_, begin));
    }
  }

  void FitAndStream(size_t whole) {
    for (size_t begin = 0; begin < whole; begin += kTileObjects) {
      OutputTile<kDims> output(job_, begin);
      FitTile<StoreMode::kCached>(begin, output.places);
      output.StreamOut();
    }
  }

  template <StoreMode kStore>
  void FitTile(size_t begin, const OutputPlanes<kDims>& output) {
    const float* columns[Builder::kColumns] = {};
    if (is_read_in_place_) {
      ListColumns(columns, begin);
    } else {
      builder_.Read(tile_, job_, begin, kTileObjects);
      for (size_t c = 0; c < Builder::kColumns; ++c) {
        columns[c] = tile_.columns[c];
      }
    }
    FitVectors<kStore>(columns, output, kTileObjects, begin);
  }

  // Lists the columns of the caller. Some builders have more columns in their
  // tiles, and never read those here.
  void ListColumns(const float** columns, size_t begin) const {
    constexpr size_t kMost = detail::kMaxPlanes;
    for (size_t c = 0; c < HWY_MIN(Builder::kColumns, kMost); ++c) {
      columns[c] = job_.columns.floats(c) + begin;
    }
  }

  // Bounds `count` shapes, rounded up to whole vectors.
  template <StoreMode kStore>
  void FitVectors(const float* const* columns,
                  const OutputPlanes<kDims>& output, size_t count,
                  size_t begin) {
    const typename Builder::Tag d;
    for (size_t i = 0; i < count; i += hn::Lanes(d)) {
      builder_.template FitVector<kStore>(d, columns, output, i, begin, tally_);
    }
  }

  void FitRest(size_t begin, size_t count) {
    tile_.Clear();
    builder_.Read(tile_, job_, begin, count);
    OutputTile<kDims> output(job_, begin);
    FitVectors<StoreMode::kCached>(tile_.columns, output.places, count, begin);
    output.Write(count);
  }

  const Builder& builder_;
  const kernels::FitJob& job_;
  const bool is_read_in_place_;
  kernels::FitTally& tally_;
  InputTile<Builder::kColumns> tile_;
};

// Bounds all shapes of a job. `is_read_in_place` says that the Builder can read
// the columns of the job as they are.
template <class Builder>
kernels::FitTally FitAll(const Builder& builder, const kernels::FitJob& job,
                         bool is_read_in_place) {
  kernels::FitTally tally{.target = HWY_TARGET};
  TileWalk<Builder>(builder, job, is_read_in_place, tally).Run();
  return tally;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_TILES_INL_H_
