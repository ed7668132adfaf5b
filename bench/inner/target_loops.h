// Loops that the library does not offer, compiled for each target as its
// kernels are: what they are measured by, and the other volumes and schedules
// of the experiments.
//
// Planes are in the kernels' order, all minima, then all maxima; so are the
// values of a query. Masks are of `size` objects, a multiple of 64.
#ifndef HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
#define HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/base/shape.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

// Reading planes and nothing else: the ceiling of a scan.
enum class ReadWay : std::size_t {
  kByPlane,   // one plane after the other
  kByHalves,  // the same, as two streams
  kByWord,    // 256 bytes of each plane in turn, as a flat kernel
};
inline constexpr std::array<ReadWay, 3> kReadWays = {
    ReadWay::kByPlane, ReadWay::kByHalves, ReadWay::kByWord};

constexpr const char* NameOf(ReadWay way) {
  constexpr const char* kNames[] = {"by-plane", "by-halves", "by-word"};
  return kNames[static_cast<std::size_t>(way)];
}

// What is read must be a multiple of this.
inline constexpr std::size_t kReadBytes = 256;

// Reads `bytes` of each plane. Returns all words ORed, so that no read can be
// left out.
using PlaneReader = std::uint32_t (*)(ReadWay way,
                                      const unsigned char* const* planes,
                                      std::size_t plane_count,
                                      std::size_t bytes);

using BytePlanes = std::vector<const unsigned char*>;

template <typename T>
BytePlanes BytesOf(const std::vector<const T*>& planes) {
  BytePlanes bytes;
  for (const T* plane : planes) {
    bytes.push_back(reinterpret_cast<const unsigned char*>(plane));
  }
  return bytes;
}

// Reading and writing as many bytes as a bulk builder: its ceiling.
enum class CopyWay : std::size_t {
  kInterleaved,          // 128 objects of each stream in turn, as a builder
  kInterleavedStreamed,  // the same with stores past the caches
  kByPage,               // 1024 objects
  kByPageStreamed,
};
inline constexpr std::array<CopyWay, 4> kCopyWays = {
    CopyWay::kInterleaved, CopyWay::kInterleavedStreamed, CopyWay::kByPage,
    CopyWay::kByPageStreamed};

constexpr const char* NameOf(CopyWay way) {
  constexpr const char* kNames[] = {"interleaved", "interleaved-streamed",
                                    "by-page", "by-page-streamed"};
  return kNames[static_cast<std::size_t>(way)];
}
constexpr bool IsStreamed(CopyWay way) {
  return way == CopyWay::kInterleavedStreamed ||
         way == CopyWay::kByPageStreamed;
}
constexpr std::size_t ObjectsAtOnce(CopyWay way) {
  return way == CopyWay::kByPage || way == CopyWay::kByPageStreamed ? 1024
                                                                    : 128;
}

// The objects of a job must be a multiple of this.
inline constexpr std::size_t kCopyObjects = 128;

// Arrays that describe the same objects in the same order. An object has an
// even number of bytes in each; those to be written are aligned to 64 bytes.
struct CopyJob {
  template <typename Byte>
  struct Stream {
    Byte* begin;
    std::size_t object_bytes;
  };
  std::size_t objects = 0;
  std::vector<Stream<const unsigned char>> reads;
  std::vector<Stream<unsigned char>> writes;

  template <typename T>
  void Read(const T* begin, std::size_t count) {
    reads.push_back({reinterpret_cast<const unsigned char*>(begin),
                     count * sizeof(T) / objects});
  }
  void Write(float* begin, std::size_t count) {
    writes.push_back({reinterpret_cast<unsigned char*>(begin),
                      count * sizeof(float) / objects});
  }
  std::size_t bytes() const {
    std::size_t of_object = 0;
    for (const auto& stream : reads) of_object += stream.object_bytes;
    for (const auto& stream : writes) of_object += stream.object_bytes;
    return objects * of_object;
  }
};

// Reads every byte once and writes every byte once. What is written is the OR
// of what has been read before, so that no read can be left out.
using StreamCopier = void (*)(CopyWay way, const CopyJob& job);

// The paper's schedule: after every half-space, a batch of `width` objects that
// are all rejected skips the rest. `width` is a power of two from the target's
// lane count to kWidestGate, `size` a multiple of kWidestGate. Writes the
// reject mask.
inline constexpr std::size_t kWidestGate = 4096;
using GatedScan = void (*)(ShapeKind shape, std::size_t width,
                           const float* const* planes, const float* query,
                           std::size_t size, std::uint64_t* mask);

// The same work in groups of 16 objects (of 64 where the length of vectors is
// not known): after each stage of one or two planes, a group without a survivor
// skips the rest.
enum class StageWay : std::size_t {
  kBranches,  // a group after the other, with a branch after each stage
  kLists,     // a stage after the other. The groups that are left are listed,
              // without a branch
};
inline constexpr std::array<StageWay, 2> kStageWays = {StageWay::kBranches,
                                                       StageWay::kLists};

constexpr const char* NameOf(StageWay way) {
  constexpr const char* kNames[] = {"branches", "lists"};
  return kNames[static_cast<std::size_t>(way)];
}

// `planes_of_stage` is 1 or 2. Writes the reject mask.
using StagedScan = void (*)(ShapeKind shape, StageWay way,
                            std::size_t planes_of_stage,
                            const float* const* planes, const float* query,
                            std::size_t size, std::uint64_t* mask);

// Which objects each plane of an octahedron rejects by itself. Plane p of
// objects i ... i + 63: all minima (X, Y, Z, D), then all maxima.
inline constexpr std::size_t kPlaneWordsPlanes = 8;
using PlaneWords = std::array<std::uint64_t, kPlaneWordsPlanes>;
using PlaneWordsFunction = void (*)(const float* const* planes,
                                    const float* query, std::size_t words,
                                    PlaneWords* out);

// Other bounding volumes. Writes the survivor mask. Planes are aligned to 64
// bytes:
//   sphere       x, y, z, radius, in planes and query. Rejects by the squared
//                distance of the centers; by axis, by that along x first.
//   seven sides  the box as the public aabo benchmark tests it, which accepts
//                what the box accepts: its own up simplex, then its maxima.
//                Planes: min X, min Y, min Z, min D, max X, max Y, max Z;
//                query: max X, max Y, max Z, max D, min X, min Y, min Z
using VolumeScan = void (*)(const float* const* planes, const float* query,
                            std::size_t size, std::uint64_t* mask);

// Counts the survivors of each query, by tiles of objects, in a loop that the
// compiler vectorises.
struct SimplexJob {
  const float* planes[4];
  std::size_t objects;
  const float* queries;  // 4 each
  std::size_t query_count;
  std::size_t* counts;
};
using CountSimplices = void (*)(const SimplexJob& job);

// The same kernel for both shapes with vectors of `lanes` floats, 0 if the
// target has none. Writes the reject mask. Staged: two planes of all objects,
// then two more of the groups that still have a survivor.
using WidthScan = void (*)(const float* const* planes, const float* query,
                           std::size_t size, std::uint64_t* mask);
struct WidthLoops {
  std::size_t lanes = 0;
  WidthScan simplex_flat = nullptr;
  WidthScan simplex_staged = nullptr;
  WidthScan box_flat = nullptr;
  WidthScan box_staged = nullptr;
};

struct TargetLoops {
  // Of the vectors that test floats for one query in the library.
  std::size_t (*one_query_lanes)() = nullptr;
  PlaneReader read = nullptr;
  StreamCopier copy = nullptr;
  GatedScan scan_gated = nullptr;
  StagedScan scan_staged = nullptr;
  PlaneWordsFunction fill_plane_words = nullptr;
  VolumeScan scan_seven_sided = nullptr;
  VolumeScan scan_spheres = nullptr;
  VolumeScan scan_spheres_by_axis = nullptr;
  CountSimplices count_by_or = nullptr;
  CountSimplices count_by_and = nullptr;
  std::array<WidthLoops, 4> widths = {};  // 1, 4, 8 and 16 lanes
};

// Of a supported target.
TargetLoops LoopsFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
