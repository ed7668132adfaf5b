#include "tree.h"

#include <halfspace/bvh_nearest.h>
#include <halfspace/bvh_pairs.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

using Ids = py::array_t<std::int64_t>;

// Queries of one part: few enough that Ctrl-C is seen soon, and enough that
// SurvivorsOfEach() can walk many of them together.
constexpr std::size_t kPartQueries = 512;
// Leaves of one part of a join.
constexpr std::size_t kPartLeaves = 16;
// A BVH has fewer objects.
constexpr std::size_t kMostObjects = std::size_t{1} << 31;
// Rows of one part of a pass over an output.
constexpr std::size_t kPartRows = 65536;

template <typename AnyBvh>
constexpr int kDimsOf = std::decay_t<AnyBvh>::Bound::kDimensions;

std::size_t PartsOf(std::size_t count, std::size_t part) {
  return (count + part - 1) / part;
}

std::int64_t* Data(Ids& ids) { return ids.mutable_data(); }

// Calls function(bvh) without the interpreter's lock.
template <typename Function>
auto Read(Tree& tree, Function&& function) {
  const Reading reading(tree);
  const py::gil_scoped_release release;
  return std::visit(function, std::as_const(tree.bvh));
}
// The same with the lock, for sizes, which a refit does not change.
template <typename Function>
auto Ask(Tree& tree, const Function& function) {
  const Reading reading(tree, /*is_refit=*/true);
  return std::visit(function, std::as_const(tree.bvh));
}
template <typename Function>
void Change(Tree& tree, Function&& function, bool is_refit = false) {
  const Changing changing(tree, is_refit);
  if (is_refit) ++tree.changes;  // also if an exception ends it
  {
    const py::gil_scoped_release release;
    std::visit(function, tree.bvh);
  }
  if (!is_refit) ++tree.changes;
}

void CheckColumns(const Tree& tree, const Columns& columns, bool is_points) {
  const std::size_t dims = tree.bvh.index() == 0 ? 2 : 3;
  if (columns.columns() != (is_points ? dims : 2 * dims)) {
    throw std::invalid_argument("_halfspace: columns of other dimensions");
  }
}

// A world that never had an object has an empty blob, from which nobody could
// tell its dimensions. One with room has a header.
template <typename AnyBvh>
void MakeRoom(AnyBvh& bvh) {
  if (bvh.empty()) bvh.Reserve(1);
}

template <int kDims>
Bvh<AabbView<kDims>> Build(const Columns& boxes, bool is_fast, Work& work,
                           std::size_t progress_end) {
  // Doubles are rounded, then centers, six splits, a sort and a copy; or
  // centers and a copy.
  BuildRunner runner(work, (boxes.is_double() ? 1u : 0u) + (is_fast ? 2u : 9u),
                     progress_end, boxes.count());
  BuildOptions options;
  options.quality = is_fast ? BuildQuality::kFast : BuildQuality::kHigh;
  options.run = runner;
  auto bvh = boxes.WithBoxes<kDims>([&](const auto& shapes) {
    return Bvh<AabbView<kDims>>(shapes, options);
  });
  MakeRoom(bvh);
  return bvh;
}

std::unique_ptr<Tree> MakeTree(const py::tuple& arrays, bool is_fast,
                               std::size_t threads, py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  auto tree = std::make_unique<Tree>();
  const py::gil_scoped_release release;
  if (boxes.columns() == 4) {
    tree->bvh = Build<2>(boxes, is_fast, work, boxes.count());
  } else if (boxes.columns() == 6) {
    tree->bvh = Build<3>(boxes, is_fast, work, boxes.count());
  } else {
    throw std::invalid_argument("_halfspace: boxes with other columns");
  }
  work.SetStage(0, 0, boxes.count());
  work.Finish();
  return tree;
}

template <typename AnyBvh>
AnyBvh Load(Span<const std::byte> blob, bool is_in_place) {
  return is_in_place ? AnyBvh::InPlace(blob) : AnyBvh::FromBlob(blob);
}

// In place if the bytes are aligned, and else a copy.
std::unique_ptr<Tree> FromBlob(const py::object& object, bool verify) {
  constexpr std::size_t kAlignment = 64;
  auto buffer = std::make_unique<Buffer>(object);
  const Span<const std::byte> blob = buffer->bytes();
  if (blob.empty()) throw std::invalid_argument("the blob is empty");
  const bool is_in_place =
      reinterpret_cast<std::uintptr_t>(blob.data()) % kAlignment == 0;
  auto tree = std::make_unique<Tree>();
  if (is_in_place) tree->buffer = std::move(buffer);
  const py::gil_scoped_release release;
  try {
    tree->bvh = Load<AabbBvh3>(blob, is_in_place);
  } catch (const std::invalid_argument& error) {
    // The number of dimensions is checked after the beginning and the version,
    // and before everything else.
    if (std::strstr(error.what(), "dimensions") == nullptr) throw;
    tree->bvh = Load<AabbBvh2>(blob, is_in_place);
  }
  if (verify &&
      !std::visit([](const auto& bvh) { return bvh.Verify(); }, tree->bvh)) {
    throw std::invalid_argument(
        "the blob was altered: its checksum does not match its bytes");
  }
  return tree;
}

// Refers to the bytes of a tree. The tree cannot change while it lives.
class Blob {
 public:
  explicit Blob(py::object object)
      : object_(std::move(object)), tree_(object_.cast<Tree&>()) {
    bytes_ = Read(tree_, [](const auto& bvh) { return bvh.Blob(); });
    ++tree_.exports;
  }
  ~Blob() { --tree_.exports; }
  Blob(const Blob&) = delete;
  Blob& operator=(const Blob&) = delete;

  py::buffer_info Info() const {
    return {const_cast<std::byte*>(bytes_.data()),
            1,
            py::format_descriptor<std::uint8_t>::format(),
            1,
            {static_cast<py::ssize_t>(bytes_.size())},
            {1},
            /*readonly=*/true};
  }

 private:
  py::object object_;  // the Python object of the tree
  Tree& tree_;
  Span<const std::byte> bytes_;
};

// Finds the ids for a part of the queries, grouped by query, and counts them.
template <int kDims>
void FindPart(const Bvh<AabbView<kDims>>& bvh, const Columns& boxes,
              std::size_t part, std::size_t thread,
              Results<std::uint32_t>& results, std::uint32_t* counts) {
  const std::size_t first = part * kPartQueries;
  const std::size_t count = std::min(kPartQueries, boxes.count() - first);
  std::array<Aabb<kDims>, kPartQueries> queries;
  std::array<std::size_t, kPartQueries + 1> offsets;
  boxes.GetBoxes<kDims>(first, count, queries.data());
  results.Add(part, thread, [&](Span<std::uint32_t> ids) {
    return SurvivorsOfEach(bvh, Span<const Aabb<kDims>>(queries.data(), count),
                           ids, offsets);
  });
  for (std::size_t i = 0; i < count; ++i) {
    counts[first + i] = static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
  }
}

// Runs the queries one after another. Returns the rows and the ids, of shape
// (2, n), or only the ids, of shape (n).
Ids QueryInTurn(Tree& tree, const Columns& boxes, bool with_rows, Work& work) {
  const std::size_t parts = PartsOf(boxes.count(), kPartQueries);
  work.SetStage(0, boxes.count(), boxes.count());
  Results<std::uint32_t> results(parts, work.threads());
  std::vector<std::uint32_t> counts(boxes.count());
  const std::vector<std::size_t> offsets = Read(tree, [&](const auto& bvh) {
    work.Run(parts, [&](std::size_t part, std::size_t thread) {
      FindPart<kDimsOf<decltype(bvh)>>(bvh, boxes, part, thread, results,
                                       counts.data());
    });
    return results.Offsets();
  });
  const std::size_t found = offsets.back();
  Ids ids(with_rows ? std::vector<std::size_t>{2, found}
                    : std::vector<std::size_t>{found});
  std::int64_t* const rows = Data(ids);
  std::int64_t* const objects = rows + (with_rows ? found : 0);
  work.SetLastStage();
  const py::gil_scoped_release release;
  work.Run(parts, [&](std::size_t part, std::size_t) {
    const Span<const std::uint32_t> list = results.List(part);
    std::copy(list.begin(), list.end(), objects + offsets[part]);
    if (!with_rows) return;
    std::int64_t* row = rows + offsets[part];
    const std::size_t first = part * kPartQueries;
    const std::size_t end = std::min(boxes.count(), first + kPartQueries);
    for (std::size_t i = first; i < end; ++i) {
      row = std::fill_n(row, counts[i], static_cast<std::int64_t>(i));
    }
  });
  return ids;
}

// Finds the pairs of a tree and of another or itself, by part.
template <typename AnyBvh, typename Find>
Results<IdPair> FindPairs(const AnyBvh& bvh, Work& work, const Find& find) {
  const std::size_t parts = PartsOf(PairParts(bvh), kPartLeaves);
  work.SetStage(0, bvh.size(), bvh.size());
  Results<IdPair> results(parts, work.threads());
  work.Run(parts, [&](std::size_t part, std::size_t thread) {
    PairOptions options;
    options.begin = part * kPartLeaves;
    options.end = options.begin + kPartLeaves;
    results.Add(part, thread,
                [&](Span<IdPair> pairs) { return find(pairs, options); });
  });
  return results;
}

template <int kDims>
Results<IdPair> JoinTrees(const Bvh<AabbView<kDims>>& a,
                          const Bvh<AabbView<kDims>>& b, Work& work) {
  return FindPairs(a, work,
                   [&](Span<IdPair> pairs, const PairOptions& options) {
                     return Pairs(a, b, pairs, options);
                   });
}

// Sorts the queries into a tree of their own and joins the trees: queries that
// are near each other share what they read. Then sorts the pairs by row.
Ids QueryByJoin(Tree& tree, const Columns& boxes, Work& work) {
  const auto results = Read(tree, [&](const auto& bvh) {
    const auto queries = Build<kDimsOf<decltype(bvh)>>(
        boxes, /*is_fast=*/true, work, /*progress_end=*/0);
    return JoinTrees(queries, bvh, work);
  });
  const std::size_t count = boxes.count();
  const std::size_t parts = results.parts();
  work.SetLastStage();
  std::vector<std::size_t> next(count);
  std::size_t found = 0;
  {
    const py::gil_scoped_release release;
    // All pairs of a row are in one part.
    work.Run(parts, [&](std::size_t part, std::size_t) {
      for (const IdPair& pair : results.List(part)) ++next[pair.a];
    });
    for (std::size_t& row : next) found += std::exchange(row, found);
  }
  Ids ids(std::vector<std::size_t>{2, found});
  std::int64_t* const rows = Data(ids);
  std::int64_t* const objects = rows + found;
  const py::gil_scoped_release release;
  work.Run(parts, [&](std::size_t part, std::size_t) {
    for (const IdPair& pair : results.List(part)) {
      objects[next[pair.a]++] = pair.b;
    }
  });
  // Now next[i] is the end of row i.
  work.Run(PartsOf(count, kPartRows), [&](std::size_t part, std::size_t) {
    const std::size_t first = part * kPartRows;
    const std::size_t end = std::min(count, first + kPartRows);
    std::size_t begin = first == 0 ? 0 : next[first - 1];
    for (std::size_t i = first; i < end; begin = next[i++]) {
      std::fill(rows + begin, rows + next[i], static_cast<std::int64_t>(i));
    }
  });
  return ids;
}

// As measured with 10^3 to 10^6 objects and 10^4 to 10^6 queries. With fewer
// queries the leaves of their tree are too large, more so in 3 dimensions, and
// a join reads more: it takes up to 5 times as long. With many results it takes
// up to twice as long, because it sorts them. The row of a query is an id in
// their tree.
bool IsJoinFaster(Tree& tree, const Columns& boxes) {
  constexpr std::size_t kSample = 64;
  constexpr std::size_t kLargeTree = std::size_t{1} << 18;
  const std::size_t queries = boxes.count();
  if (queries < 4096 || queries >= kMostObjects) return false;
  return Read(tree, [&](const auto& bvh) {
    constexpr int kDims = kDimsOf<decltype(bvh)>;
    if (queries < bvh.size() / (kDims == 2 ? 10 : 4)) return false;
    std::size_t found = 0;
    for (std::size_t i = 0; i < kSample; ++i) {
      Aabb<kDims> query;
      boxes.GetBoxes(i * (queries / kSample), 1, &query);
      found += CountSurvivors(bvh, query);
    }
    // In a large tree, queries in turn also miss the cache.
    const std::size_t many_results = bvh.size() < kLargeTree ? 8 : 16;
    return found < many_results * kSample;
  });
}

Ids Query(Tree& tree, const py::tuple& arrays, bool with_rows,
          std::size_t threads, py::object progress) {
  const Columns boxes(arrays);
  CheckColumns(tree, boxes, false);
  Work work(threads, std::move(progress));
  Ids ids = with_rows && IsJoinFaster(tree, boxes)
                ? QueryByJoin(tree, boxes, work)
                : QueryInTurn(tree, boxes, with_rows, work);
  work.Finish();
  return ids;
}

// query() of one box in a plain array, in a third of the time: most of a short
// query is the way through Python. None if the array is anything else.
py::object QueryOne(Tree& tree, const py::array& array) {
  const Reading reading(tree);
  return std::visit(
      [&](const auto& bvh) -> py::object {
        constexpr int kDims = kDimsOf<decltype(bvh)>;
        const auto box = BoxIn<kDims>(array);
        if (!box) return py::none();
        std::array<std::uint32_t, 256> few;
        std::vector<std::uint32_t> many;
        Span<std::uint32_t> found = few;
        std::size_t count = 0;
        {
          const py::gil_scoped_release release;
          count = Survivors(bvh, *box, found);
          if (count > found.size()) {
            many.resize(count);
            found = many;
            count = Survivors(bvh, *box, found);
          }
        }
        Ids ids(Size(count));
        std::copy_n(found.data(), count, Data(ids));
        return ids;
      },
      std::as_const(tree.bvh));
}

// Returns at most `limit` ids of one query, after the first `skip`.
Ids QuerySome(Tree& tree, const py::tuple& arrays, std::size_t skip,
              std::size_t limit) {
  const Columns boxes(arrays);
  CheckColumns(tree, boxes, false);
  std::vector<std::uint32_t> found(limit);
  const std::size_t total = Read(tree, [&](const auto& bvh) {
    Aabb<kDimsOf<decltype(bvh)>> query;
    boxes.GetBoxes(0, 1, &query);
    return Survivors(bvh, query, found, {}, skip);
  });
  Ids ids(Size(std::min(limit, total - std::min(skip, total))));
  std::copy_n(found.data(), ids.size(), Data(ids));
  return ids;
}

// Calls some(bvh, queries, first) for all queries, a part of them at a time.
template <typename Some>
void ForEachQueries(Tree& tree, const Columns& boxes, Work& work,
                    const Some& some) {
  CheckColumns(tree, boxes, false);
  work.SetStage(0, boxes.count(), boxes.count());
  Read(tree, [&](const auto& bvh) {
    using Box = typename std::decay_t<decltype(bvh)>::Bound;
    work.Run(PartsOf(boxes.count(), kPartQueries), [&](std::size_t part,
                                                       std::size_t) {
      const std::size_t first = part * kPartQueries;
      const std::size_t count = std::min(kPartQueries, boxes.count() - first);
      std::array<Box, kPartQueries> queries;
      boxes.GetBoxes<Box::kDimensions>(first, count, queries.data());
      some(bvh, Span<const Box>(queries.data(), count), first);
    });
    work.Finish();
  });
}

Ids Count(Tree& tree, const py::tuple& arrays, std::size_t threads,
          py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  Ids counts(Size(boxes.count()));
  std::int64_t* const to = Data(counts);
  ForEachQueries(tree, boxes, work,
                 [to](const auto& bvh, const auto& queries, std::size_t first) {
                   std::array<std::size_t, kPartQueries> its_counts;
                   CountSurvivorsOfEach(bvh, queries, its_counts);
                   std::copy_n(its_counts.data(), queries.size(), to + first);
                 });
  return counts;
}

py::array_t<bool> Any(Tree& tree, const py::tuple& arrays, std::size_t threads,
                      py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  py::array_t<bool> found(Size(boxes.count()));
  bool* const to = found.mutable_data();
  ForEachQueries(tree, boxes, work,
                 [to](const auto& bvh, const auto& queries, std::size_t first) {
                   for (std::size_t i = 0; i < queries.size(); ++i) {
                     to[first + i] = AnySurvivor(bvh, queries[i]).has_value();
                   }
                 });
  return found;
}

// The ids of the objects whose box is `query`, in ascending order.
template <int kDims>
void FindEqual(const Bvh<AabbView<kDims>>& bvh, const Aabb<kDims>& query,
               std::vector<std::uint32_t>& ids) {
  ids.clear();
  // A box cast that goes nowhere: unlike Survivors(), it has the bounds.
  BoxCast(bvh, query, {}, 0.0f,
          [&](std::uint32_t id, float, const Aabb<kDims>& bound) {
            if (bound == query) ids.push_back(id);
          });
  std::sort(ids.begin(), ids.end());
}

struct NearOptions {
  std::size_t k;
  float max_distance;
  bool is_exclusive;
  bool are_points;
};

// The k objects nearest to one query, without those that are equal to it.
template <int kDims>
void FindNearestOthers(const Bvh<AabbView<kDims>>& bvh,
                       const Aabb<kDims>& query, const NearOptions& options,
                       std::uint32_t* ids, float* distances) {
  std::vector<std::uint32_t> equal;
  FindEqual(bvh, query, equal);
  std::vector<std::uint32_t> found(options.k + equal.size());
  std::vector<float> its_distances(found.size());
  const std::size_t count =
      KNearest(bvh, query, found, its_distances, options.max_distance);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count && kept < options.k; ++i) {
    if (std::binary_search(equal.begin(), equal.end(), found[i])) continue;
    ids[kept] = found[i];
    distances[kept++] = its_distances[i];
  }
  std::fill(ids + kept, ids + options.k, kNoId);
  std::fill(distances + kept, distances + options.k,
            std::numeric_limits<float>::infinity());
}

template <int kDims>
void FindNearest(const Bvh<AabbView<kDims>>& bvh, const Columns& queries,
                 std::size_t first, std::size_t count,
                 const NearOptions& options, std::uint32_t* ids,
                 float* distances) {
  std::vector<Aabb<kDims>> boxes(count);
  if (options.are_points) {
    queries.GetPoints(first, count, boxes.data());
  } else {
    queries.GetBoxes(first, count, boxes.data());
  }
  const std::size_t k = options.k;
  if (options.is_exclusive) {
    for (std::size_t i = 0; i < count; ++i) {
      FindNearestOthers(bvh, boxes[i], options, ids + i * k, distances + i * k);
    }
  } else if (options.are_points && !queries.is_double()) {
    std::vector<Point<kDims>> points;
    points.reserve(count);
    for (const Aabb<kDims>& box : boxes) points.push_back(box.min);
    KNearestOfEach(bvh, points, k, {ids, count * k}, {distances, count * k},
                   options.max_distance);
  } else {
    KNearestOfEach(bvh, boxes, k, {ids, count * k}, {distances, count * k},
                   options.max_distance);
  }
}

py::tuple Nearest(Tree& tree, const py::tuple& arrays, std::size_t k,
                  double max_distance, bool is_exclusive, std::size_t threads,
                  py::object progress) {
  const Columns queries(arrays);
  const std::size_t dims = tree.bvh.index() == 0 ? 2 : 3;
  const bool are_points = queries.columns() == dims;
  CheckColumns(tree, queries, are_points);
  const std::size_t n = queries.count();
  Ids ids(std::vector<std::size_t>{n, k});
  py::array_t<float> distances(std::vector<std::size_t>{n, k});
  std::int64_t* const to = Data(ids);
  float* const its_distances = distances.mutable_data();
  Work work(threads, std::move(progress));
  work.SetStage(0, n, n);
  Read(tree, [&](const auto& bvh) {
    // More than there are need no memory to search with.
    const NearOptions options = {std::clamp(bvh.size(), std::size_t{1}, k),
                                 RoundUp(max_distance), is_exclusive,
                                 are_points};
    // As many queries in a part as have about this number of results.
    constexpr std::size_t kPartResults = 4096;
    std::size_t in_part =
        std::clamp(kPartResults / k, std::size_t{1}, kPartQueries);
    // A search for others also finds all objects that are equal to its query.
    if (is_exclusive) in_part = std::min(in_part, std::size_t{4});
    work.Run(PartsOf(n, in_part), [&](std::size_t part, std::size_t) {
      const std::size_t first = part * in_part;
      const std::size_t count = std::min(in_part, n - first);
      std::vector<std::uint32_t> found(count * options.k);
      std::vector<float> found_distances(found.size());
      FindNearest(bvh, queries, first, count, options, found.data(),
                  found_distances.data());
      for (std::size_t i = 0; i < count; ++i) {
        std::int64_t* const row = to + (first + i) * k;
        for (std::size_t j = 0; j < options.k; ++j) {
          const std::uint32_t id = found[i * options.k + j];
          row[j] = id == kNoId ? -1 : std::int64_t{id};
        }
        std::fill(row + options.k, row + k, -1);
        float* const distance_row = its_distances + (first + i) * k;
        std::copy_n(found_distances.data() + i * options.k, options.k,
                    distance_row);
        std::fill(distance_row + options.k, distance_row + k,
                  std::numeric_limits<float>::infinity());
      }
    });
    work.Finish();
  });
  return py::make_tuple(ids, distances);
}

py::tuple CastRays(Tree& tree, const py::tuple& origin_arrays,
                   const py::tuple& direction_arrays,
                   const py::tuple& limit_arrays, std::size_t threads,
                   py::object progress) {
  const Columns origins(origin_arrays);
  const Columns directions(direction_arrays);
  const Columns limits(limit_arrays);
  CheckColumns(tree, origins, true);
  CheckColumns(tree, directions, true);
  const std::size_t n = origins.count();
  if (directions.count() != n || limits.count() != n || limits.columns() < 1) {
    throw std::invalid_argument("_halfspace: arrays of different lengths");
  }
  Ids ids(Size(n));
  py::array_t<float> distances(Size(n));
  std::int64_t* const to = Data(ids);
  float* const its_distances = distances.mutable_data();
  Work work(threads, std::move(progress));
  work.SetStage(0, n, n);
  Read(tree, [&](const auto& bvh) {
    constexpr int kDims = kDimsOf<decltype(bvh)>;
    const auto cast = [&](std::size_t i) {
      const Ray<kDims> ray = {origins.GetPoint<kDims>(i),
                              directions.GetPoint<kDims>(i), limits.Get(i, 0)};
      FindFirst(to[i], its_distances[i],
                [&](const auto& function) { RayCast(bvh, ray, function); });
    };
    work.Run(PartsOf(n, kPartQueries), [&](std::size_t part, std::size_t) {
      const std::size_t end = std::min(n, (part + 1) * kPartQueries);
      for (std::size_t i = part * kPartQueries; i < end; ++i) cast(i);
    });
    work.Finish();
  });
  return py::make_tuple(ids, distances);
}

// Returns the pairs in an array of shape (2, n), with i < j if `is_ordered`.
Ids ToArray(const Results<IdPair>& results, bool is_ordered, Work& work) {
  const std::vector<std::size_t> offsets = results.Offsets();
  const std::size_t found = offsets.back();
  Ids ids(std::vector<std::size_t>{2, found});
  std::int64_t* const to = Data(ids);
  work.SetLastStage();
  const py::gil_scoped_release release;
  work.Run(offsets.size() - 1, [&](std::size_t part, std::size_t) {
    std::size_t at = offsets[part];
    for (IdPair pair : results.List(part)) {
      if (is_ordered && pair.b < pair.a) std::swap(pair.a, pair.b);
      to[at] = pair.a;
      to[found + at] = pair.b;
      ++at;
    }
  });
  work.Finish();
  return ids;
}

Ids PairsOfOne(Tree& tree, std::size_t threads, py::object progress) {
  Work work(threads, std::move(progress));
  const auto results = Read(tree, [&](const auto& bvh) {
    return FindPairs(bvh, work,
                     [&](Span<IdPair> pairs, const PairOptions& options) {
                       return Pairs(bvh, pairs, options);
                     });
  });
  return ToArray(results, true, work);
}

Ids Join(Tree& a, Tree& b, std::size_t threads, py::object progress) {
  if (a.bvh.index() != b.bvh.index()) {
    throw std::invalid_argument("_halfspace: trees of different dimensions");
  }
  Work work(threads, std::move(progress));
  const Reading reading(b);
  const auto results = Read(a, [&](const auto& bvh) {
    return JoinTrees(bvh, std::get<std::decay_t<decltype(bvh)>>(b.bvh), work);
  });
  return ToArray(results, false, work);
}

template <int kDims>
std::vector<Aabb<kDims>> AllBoxes(const Columns& boxes) {
  std::vector<Aabb<kDims>> bounds(boxes.count());
  boxes.GetBoxes(0, boxes.count(), bounds.data());
  return bounds;
}

using ShortIds = py::array_t<std::uint32_t, py::array::c_style>;

Ids Insert(Tree& tree, const py::tuple& arrays) {
  const Columns boxes(arrays);
  CheckColumns(tree, boxes, false);
  std::vector<std::uint32_t> ids(boxes.count());
  Change(tree, [&](auto& bvh) {
    const auto bounds = AllBoxes<kDimsOf<decltype(bvh)>>(boxes);
    bvh.Insert(bounds, ids);
  });
  Ids result(Size(ids.size()));
  std::copy(ids.begin(), ids.end(), Data(result));
  return result;
}

template <typename AnyBvh>
void CheckIds(const AnyBvh& bvh, Span<const std::uint32_t> ids) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (bvh.Has(ids[i])) continue;
    throw std::invalid_argument("ids[" + std::to_string(i) +
                                "] = " + std::to_string(ids[i]) +
                                " is not the id of an object");
  }
}

void Erase(Tree& tree, const ShortIds& ids) {
  const Span<const std::uint32_t> list(ids.data(),
                                       static_cast<std::size_t>(ids.size()));
  Change(tree, [&](auto& bvh) {
    CheckIds(bvh, list);
    bvh.Erase(list);
  });
}

void Refit(Tree& tree, const py::tuple& arrays, std::size_t threads,
           py::object progress) {
  const Columns boxes(arrays);
  CheckColumns(tree, boxes, false);
  Work work(threads, std::move(progress));
  // A refit of doubles rounds first.
  BuildRunner runner(work, boxes.is_double() ? 2 : 1, boxes.count(),
                     boxes.count());
  const auto refit = [&](auto& bvh) {
    tree.is_half_refitted = true;
    boxes.WithBoxes<kDimsOf<decltype(bvh)>>(
        [&](const auto& shapes) { bvh.Refit(shapes, runner); });
    tree.is_half_refitted = false;
    work.Finish();
  };
  Change(tree, refit, /*is_refit=*/true);
}

void RefitSome(Tree& tree, const py::tuple& arrays, const ShortIds& ids) {
  const Columns boxes(arrays);
  CheckColumns(tree, boxes, false);
  const Span<const std::uint32_t> list(ids.data(),
                                       static_cast<std::size_t>(ids.size()));
  Change(tree, [&](auto& bvh) {
    CheckIds(bvh, list);
    bvh.Set(list, AllBoxes<kDimsOf<decltype(bvh)>>(boxes));
  });
}

py::array_t<float> BoundsOf(Tree& tree) {
  const Reading reading(tree);
  return Ask(tree, [](const auto& bvh) {
    const auto bounds = bvh.Bounds();
    py::array_t<float> values(Size(2 * bounds.min.size()));
    std::copy(bounds.min.begin(), bounds.min.end(), values.mutable_data());
    std::copy(bounds.max.begin(), bounds.max.end(),
              values.mutable_data() + bounds.min.size());
    return values;
  });
}

// The boxes by id, one after another; that of no object is empty.
py::array_t<float> Boxes(Tree& tree) {
  const std::size_t dims = tree.bvh.index() == 0 ? 2 : 3;
  const std::size_t n =
      Ask(tree, [](const auto& bvh) { return bvh.id_limit(); });
  py::array_t<float> values(std::vector<std::size_t>{n, 2 * dims});
  float* const to = values.mutable_data();
  Read(tree, [to, n](const auto& bvh) {
    using Box = typename std::decay_t<decltype(bvh)>::Bound;
    const auto put = [to](std::size_t id, const Box& box) {
      constexpr std::size_t kAxes = Box::kAxes;
      float* const row = to + id * 2 * kAxes;
      std::copy(box.min.begin(), box.min.end(), row);
      std::copy(box.max.begin(), box.max.end(), row + kAxes);
    };
    for (std::size_t id = 0; id < n; ++id) put(id, Box::Empty());
    // Nothing limits this box, so its cast finds all objects, in one pass.
    Box all = Box::Empty();
    std::swap(all.min, all.max);
    BoxCast(bvh, all, {}, 0.0f,
            [&put, n](std::uint32_t id, float, const Box& box) {
              if (id < n) put(id, box);  // an altered blob can have any id
            });
  });
  return values;
}

}  // namespace

Buffer::Buffer(const py::object& object) {
  if (PyObject_GetBuffer(object.ptr(), &view_, PyBUF_SIMPLE) != 0) {
    throw py::error_already_set();
  }
}

namespace {

void CheckRefitted(const Tree& tree) {
  if (!tree.is_half_refitted) return;
  throw std::runtime_error(
      "refit() of this BVH was interrupted: call refit() with all boxes again "
      "before any other call");
}

}  // namespace

Reading::Reading(Tree& tree, bool is_refit) : tree_(tree) {
  if (tree.is_changing) {
    throw std::runtime_error(
        "another call is changing this BVH: wait until it has finished");
  }
  if (!is_refit) CheckRefitted(tree);
  ++tree.readers;
}

Changing::Changing(Tree& tree, bool is_refit) : tree_(tree) {
  if (tree.is_changing || tree.readers > 0) {
    throw std::runtime_error(
        "another call is using this BVH: wait until it has finished before "
        "you change the BVH");
  }
  if (tree.exports > 0) {
    throw py::buffer_error(
        "the blob of this BVH is in use: release it before you change the BVH");
  }
  if (!is_refit) CheckRefitted(tree);
  tree.is_changing = true;
}

void DefineTree(py::module_& module) {
  py::class_<Blob>(module, "Blob", py::buffer_protocol())
      .def(py::init<py::object>())
      .def_buffer(&Blob::Info);
  py::class_<Tree>(module, "Tree")
      .def(py::init(&MakeTree))
      .def_static("from_blob", &FromBlob)
      .def("query", &Query)
      .def("query_one", &QueryOne)
      .def("query_some", &QuerySome)
      .def("count", &Count)
      .def("any", &Any)
      .def("nearest", &Nearest)
      .def("raycast", &CastRays)
      .def("pairs", &PairsOfOne)
      .def("insert", &Insert)
      .def("erase", &Erase)
      .def("refit", &Refit)
      .def("refit_some", &RefitSome)
      .def("bounds", &BoundsOf)
      .def("boxes", &Boxes)
      .def("size",
           [](Tree& tree) {
             return Ask(tree, [](const auto& bvh) { return bvh.size(); });
           })
      .def("id_limit",
           [](Tree& tree) {
             return Ask(tree, [](const auto& bvh) { return bvh.id_limit(); });
           })
      .def("nbytes",
           [](Tree& tree) {
             return Ask(tree, [](const auto& bvh) { return bvh.bytes(); });
           })
      .def_property_readonly(
          "dims",
          [](const Tree& tree) { return tree.bvh.index() == 0 ? 2 : 3; })
      .def_readonly("changes", &Tree::changes);
  module.def("join", &Join);
}

}  // namespace halfspace::python
