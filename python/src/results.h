// The queries of a call in parts, on several threads, and their results as
// NumPy arrays. Each part finds a list, whose length is known only at its end.
#ifndef HALFSPACE_PYTHON_RESULTS_H_
#define HALFSPACE_PYTHON_RESULTS_H_

#include <halfspace/c/halfspace.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "columns.h"
#include "work.h"

namespace halfspace::python {

// Queries of one part: few enough that Ctrl-C is seen soon, and enough that
// hs_bvh_query() can walk many of them together.
inline constexpr std::size_t kPartQueries = 512;

inline std::size_t PartsOf(std::size_t count, std::size_t in_part) {
  return (count + in_part - 1) / in_part;
}

template <typename Item>
class Results {
 public:
  Results(std::size_t parts, std::size_t threads)
      : lists_(parts), blocks_(threads) {}

  // Stores what find(span<Item>) writes for a part. find() returns the full
  // number of items. It is called again with a longer span until all of them
  // fit: the second call can find more, as bodies move. Two threads may call
  // this at the same time for different parts.
  template <typename Find>
  void Add(std::size_t part, std::size_t thread, const Find& find) {
    std::vector<Block>& blocks = blocks_[thread];
    if (blocks.empty()) blocks.emplace_back(kFirstItems);
    std::size_t found = find(blocks.back().Rest());
    while (found > blocks.back().Rest().size()) {
      // Doubled, so few lists are found twice. Memory that is not touched
      // costs nothing.
      blocks.emplace_back(std::max(2 * blocks.back().size, found));
      found = find(blocks.back().Rest());
    }
    lists_[part] = blocks.back().Rest().first(found);
    blocks.back().used += found;
  }

  // Returns where the items of each part begin in the list of all items, and
  // then the number of all items. Call it after all parts.
  std::vector<std::size_t> Offsets() const {
    std::vector<std::size_t> offsets{0};
    offsets.reserve(lists_.size() + 1);
    for (const auto& list : lists_) {
      offsets.push_back(offsets.back() + list.size());
    }
    return offsets;
  }

  std::size_t parts() const { return lists_.size(); }
  std::span<const Item> List(std::size_t part) const { return lists_[part]; }

 private:
  static constexpr std::size_t kFirstItems = 4096;

  struct Block {
    explicit Block(std::size_t items) : memory(new Item[items]), size(items) {}
    std::span<Item> Rest() const { return {memory.get() + used, size - used}; }
    std::unique_ptr<Item[]> memory;
    std::size_t size;
    std::size_t used = 0;
  };

  std::vector<std::span<const Item>> lists_;
  std::vector<std::vector<Block>> blocks_;
};

// Calls run(first, thread) for the first query of each part, without the
// interpreter's lock.
template <typename Run>
void ForEachPart(std::size_t queries, std::size_t in_part, Work& work,
                 const Run& run) {
  const pybind11::gil_scoped_release release;
  work.SetStage(0, queries, queries);
  work.Run(PartsOf(queries, in_part),
           [&](std::size_t part, std::size_t thread) {
             run(part * in_part, thread);
           });
}

// The function of FindAll() and FindOfOne() that calls hs_bvh_query() or
// hs_scan_indices().
template <typename Object, typename Function>
auto FinderOf(const Object* object, Function query) {
  return [object, query](const hs_columns& queries,
                         std::span<std::uint32_t> ids, std::size_t* offsets) {
    std::size_t total = 0;
    Check(query(object, &queries, nullptr, ids.data(), ids.size(), offsets,
                &total));
    return total;
  };
}

// Returns what find(queries, ids, offsets) writes for the queries of a part. It
// returns the number of all ids. Rows and ids have the shape (2, n), and ids
// alone (n).
template <typename Find>
Ids FindAll(const Columns& queries, std::size_t in_part, bool with_rows,
            Work& work, const Find& find) {
  Results<std::uint32_t> results(PartsOf(queries.count, in_part),
                                 work.threads());
  std::vector<std::uint32_t> counts(queries.count);
  ForEachPart(
      queries.count, in_part, work, [&](std::size_t first, std::size_t thread) {
        const hs_columns some = queries.Rows(first, in_part);
        std::array<std::size_t, kPartQueries + 1> offsets;
        results.Add(first / in_part, thread, [&](std::span<std::uint32_t> ids) {
          return find(some, ids, offsets.data());
        });
        for (std::size_t i = 0; i < some.count; ++i) {
          counts[first + i] =
              static_cast<std::uint32_t>(offsets[i + 1] - offsets[i]);
        }
      });
  const std::vector<std::size_t> offsets = results.Offsets();
  const std::size_t found = offsets.back();
  Ids ids(with_rows ? std::vector<std::size_t>{2, found}
                    : std::vector<std::size_t>{found});
  std::int64_t* const rows = ids.mutable_data();
  std::int64_t* const objects = rows + (with_rows ? found : 0);
  const pybind11::gil_scoped_release release;
  work.SetLastStage();
  work.Run(results.parts(), [&](std::size_t part, std::size_t) {
    const std::span<const std::uint32_t> list = results.List(part);
    std::copy(list.begin(), list.end(), objects + offsets[part]);
    if (!with_rows) return;
    std::int64_t* row = rows + offsets[part];
    const std::size_t first = part * in_part;
    const std::size_t end = std::min(queries.count, first + in_part);
    for (std::size_t i = first; i < end; ++i) {
      row = std::fill_n(row, counts[i], static_cast<std::int64_t>(i));
    }
  });
  return ids;
}

// FindAll() of the box of a plain array, in a third of the time: most of a
// short query is the way through Python. None if the array is anything else.
template <typename Find>
pybind11::object FindOfOne(const pybind11::array& array, std::size_t dims,
                           const Find& find) {
  const hs_columns box = BoxIn(array, dims);
  if (box.count == 0) return pybind11::none();
  std::array<std::uint32_t, 256> few;
  std::vector<std::uint32_t> many;
  std::span<std::uint32_t> found = few;
  std::size_t count = 0;
  {
    const pybind11::gil_scoped_release release;
    while ((count = find(box, found, nullptr)) > found.size()) {
      many.resize(count);
      found = many;
    }
  }
  // Less work than a constructor of py::array.
  const auto& numpy = pybind11::detail::npy_api::get();
  auto size = static_cast<Py_intptr_t>(count);
  auto ids = pybind11::reinterpret_steal<Ids>(numpy.PyArray_NewFromDescr_(
      numpy.PyArray_Type_, pybind11::dtype::of<std::int64_t>().release().ptr(),
      1, &size, nullptr, nullptr, 0, nullptr));
  if (!ids) throw pybind11::error_already_set();
  std::copy_n(found.data(), count, ids.mutable_data());
  return ids;
}

// Returns the numbers that hs_bvh_count() or hs_scan_counts() writes.
template <typename Object, typename Function>
Ids CountAll(const Object* object, Function count, const Columns& queries,
             std::size_t in_part, Work& work) {
  Ids counts(Size(queries.count));
  std::int64_t* const to = counts.mutable_data();
  ForEachPart(queries.count, in_part, work,
              [&](std::size_t first, std::size_t) {
                const hs_columns some = queries.Rows(first, in_part);
                std::array<std::size_t, kPartQueries> its;
                Check(count(object, &some, nullptr, its.data()));
                std::copy_n(its.data(), some.count, to + first);
              });
  work.Finish();
  return counts;
}

// Returns for each query whether hs_bvh_any() or hs_scan_any() writes an id.
template <typename Object, typename Function>
pybind11::array_t<bool> AnyOfAll(const Object* object, Function any,
                                 const Columns& queries, std::size_t in_part,
                                 Work& work) {
  pybind11::array_t<bool> found(Size(queries.count));
  bool* const to = found.mutable_data();
  ForEachPart(queries.count, in_part, work,
              [&](std::size_t first, std::size_t) {
                const hs_columns some = queries.Rows(first, in_part);
                std::array<std::uint32_t, kPartQueries> ids;
                Check(any(object, &some, nullptr, ids.data()));
                for (std::size_t i = 0; i < some.count; ++i)
                  to[first + i] = ids[i] != HS_NO_ID;
              });
  work.Finish();
  return found;
}

// -1 instead of HS_NO_ID.
inline std::int64_t LongId(std::uint32_t id) {
  return id == HS_NO_ID ? -1 : std::int64_t{id};
}

// Values of a box in 3 dimensions that moves.
inline constexpr std::size_t kMostValues = 10;

// Rays, or spheres or boxes that move.
struct Casts {
  Columns starts;
  Columns directions;
  Columns limits;
};

// Returns the ids and the t that cast(first, rays, motions, ids, ts) writes for
// each part. A ray has the columns of a start, of a direction and the limit, as
// the nearest floats. A motion is its end, without the start.
template <typename Cast>
pybind11::tuple CastAll(const Casts& casts, std::size_t dims, Work& work,
                        const Cast& cast) {
  const std::size_t count = casts.starts.count;
  const std::size_t start = casts.starts.size;
  const std::size_t values = start + dims + 1;
  if (casts.directions.count != count || casts.limits.count != count ||
      casts.directions.size != dims || casts.limits.size != 1 ||
      values > kMostValues) {
    ThrowNotPrepared();
  }
  const std::array<const Columns*, 3> tables{&casts.starts, &casts.directions,
                                             &casts.limits};
  Ids ids(Size(count));
  pybind11::array_t<float> ts(Size(count));
  std::int64_t* const to = ids.mutable_data();
  float* const its_ts = ts.mutable_data();
  ForEachPart(count, kPartQueries, work, [&](std::size_t first, std::size_t) {
    std::array<float, kPartQueries * kMostValues> rows;
    float* column = rows.data();
    for (const Columns* its : tables) {
      const hs_columns some = its->Rows(first, kPartQueries);
      WriteFloats(some, its->size, values, column);
      column += its->size;
    }
    const std::size_t some = std::min(kPartQueries, count - first);
    const hs_columns rays = hs_float_rows(rows.data(), some, values);
    const hs_columns motions = hs_float_rows(rows.data() + start, some, values);
    std::array<std::uint32_t, kPartQueries> its_ids;
    cast(first, rays, motions, its_ids.data(), its_ts + first);
    std::transform(its_ids.data(), its_ids.data() + some, to + first, LongId);
  });
  work.Finish();
  return pybind11::make_tuple(ids, ts);
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_RESULTS_H_
