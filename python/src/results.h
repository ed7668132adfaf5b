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

// The lists that the parts of a call find.
template <typename Item>
struct Results {
  // A thread has room for `room` items at first.
  Results(std::size_t parts, std::size_t threads, std::size_t its_room)
      : lists(parts), buffers(threads), room(its_room) {}

  // Stores what find(span<Item>) writes for a part. find() returns the full
  // number of items. It is called again with a longer span until all of them
  // fit: the second call can find more, as bodies move. Two threads may call
  // this at the same time for different parts.
  template <typename Find>
  void Add(std::size_t part, std::size_t thread, const Find& find) {
    std::vector<Item>& buffer = buffers[thread];
    if (buffer.empty()) buffer.resize(room);
    std::size_t found = find(std::span<Item>(buffer));
    while (found > buffer.size()) {
      buffer.resize(std::max(2 * buffer.size(), found));
      found = find(std::span<Item>(buffer));
    }
    lists[part].assign(buffer.data(), buffer.data() + found);
  }

  std::vector<std::vector<Item>> lists;    // of the parts
  std::vector<std::vector<Item>> buffers;  // of the threads
  std::size_t room;
};

// Calls run(some, first, thread) for the queries of each part, which are at the
// places from `first` on of their order, without the interpreter's lock.
template <typename Run>
void ForEachPart(const Columns& queries, std::size_t in_part, Work& work,
                 const Run& run) {
  const pybind11::gil_scoped_release release;
  work.SetStage(0, queries.count, queries.count);
  work.Run(PartsOf(queries.count, in_part),
           [&](std::size_t part, std::size_t thread) {
             const std::size_t first = part * in_part;
             std::vector<std::byte> copy;
             run(queries.Part(first, in_part, copy), first, thread);
           });
}

// Returns the rows and the ids, of shape (2, n). write(item, i) writes the rest
// of an item and returns its id. The results of the query at place i end at
// ends[i] of the list of its part. prepare(n) runs before write().
template <typename Item, typename Prepare, typename Write>
Ids Gather(const std::vector<std::vector<Item>>& lists,
           const std::vector<std::size_t>& ends, const Columns& queries,
           std::size_t in_part, Work& work, const Prepare& prepare,
           const Write& write) {
  // By row. Reads the results in random order and writes them in sequence: an
  // item is smaller than what is written for it.
  struct Row {
    const Item* items;
    std::size_t end;
  };
  std::vector<Row> found;
  std::size_t total = 0;
  {
    const pybind11::gil_scoped_release release;
    found.resize(queries.count);
    for (std::size_t i = 0; i < queries.count; ++i) {
      const std::size_t begin = i % in_part == 0 ? 0 : ends[i - 1];
      found[queries.RowAt(i)] = {lists[i / in_part].data() + begin,
                                 ends[i] - begin};
    }
    for (Row& row : found) row.end = total += row.end;
  }
  Ids ids(std::vector<std::size_t>{2, total});
  prepare(total);
  std::int64_t* const rows = ids.mutable_data();
  std::int64_t* const objects = rows + total;
  const pybind11::gil_scoped_release release;
  work.SetLastStage();
  constexpr std::size_t kInPart = 1024;
  // Queries that were visited in another order have their results far apart:
  // without a prefetch, a call with 40 results a row takes 1.2 times as long.
  constexpr std::size_t kAhead = 8;
  work.Run(PartsOf(found.size(), kInPart), [&](std::size_t part, std::size_t) {
    std::size_t row = part * kInPart;
    const std::size_t end = std::min(found.size(), row + kInPart);
    for (std::size_t at = row == 0 ? 0 : found[row - 1].end; row < end; ++row) {
      if (row + kAhead < found.size()) {
        __builtin_prefetch(found[row + kAhead].items);
      }
      const Item* item = found[row].items;
      std::fill(rows + at, rows + found[row].end,
                static_cast<std::int64_t>(row));
      for (; at < found[row].end; ++at, ++item) {
        objects[at] = write(*item, at);
      }
    }
  });
  return ids;
}

// Returns the rows and the ids, of shape (2, n), that find(queries, ids,
// offsets) writes for the queries of a part. It returns the number of all ids.
template <typename Find>
Ids FindAll(const Columns& queries, std::size_t in_part, Work& work,
            const Find& find) {
  const std::size_t room = std::min<std::size_t>(4096, 64 * queries.count);
  Results<std::uint32_t> results(PartsOf(queries.count, in_part),
                                 work.threads(), room);
  std::vector<std::size_t> ends(queries.count);
  ForEachPart(
      queries, in_part, work,
      [&](const hs_columns& some, std::size_t first, std::size_t thread) {
        std::array<std::size_t, kPartQueries + 1> offsets;
        results.Add(first / in_part, thread, [&](std::span<std::uint32_t> ids) {
          return find(some, ids, offsets.data());
        });
        std::copy_n(offsets.data() + 1, some.count, ends.data() + first);
      });
  return Gather(
      results.lists, ends, queries, in_part, work, [](std::size_t) {},
      [](std::uint32_t id, std::size_t) { return id; });
}

// An object and its distance, or the t of a hit.
struct Found {
  std::uint32_t id;
  float value;
};

// Returns the rows and the ids, of shape (2, n), and the values.
// find(some, first, list, ends) appends to the list of a part, and writes where
// the results of each of its queries end.
template <typename Find>
pybind11::tuple FindLists(const Columns& queries, std::size_t in_part,
                          Work& work, const Find& find) {
  std::vector<std::vector<Found>> lists(PartsOf(queries.count, in_part));
  std::vector<std::size_t> ends(queries.count);
  ForEachPart(queries, in_part, work,
              [&](const hs_columns& some, std::size_t first, std::size_t) {
                find(some, first, lists[first / in_part], ends.data() + first);
              });
  pybind11::array_t<float> values;
  float* to = nullptr;
  const Ids ids = Gather(
      lists, ends, queries, in_part, work,
      [&](std::size_t count) {
        values = pybind11::array_t<float>(Size(count));
        to = values.mutable_data();
      },
      [&](const Found& found, std::size_t i) {
        to[i] = found.value;
        return found.id;
      });
  work.Finish();
  return pybind11::make_tuple(ids, values);
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

// An array of shape (n, 2).
inline Ids ToArray(const std::vector<hs_id_pair>& pairs) {
  Ids ids(std::vector<std::size_t>{pairs.size(), 2});
  static_assert(sizeof(hs_id_pair) == 2 * sizeof(std::uint32_t));
  std::copy_n(reinterpret_cast<const std::uint32_t*>(pairs.data()),
              2 * pairs.size(), ids.mutable_data());
  return ids;
}

// Returns an array of shape (queries, each). find(some, first, values) writes
// the values of the queries of a part.
template <typename Value, typename Find>
pybind11::array_t<Value> FindEach(const Columns& queries, std::size_t each,
                                  std::size_t in_part, Work& work,
                                  const Find& find) {
  pybind11::array_t<Value> values(
      std::vector<std::size_t>{queries.count, each});
  Value* const to = values.mutable_data();
  ForEachPart(queries, in_part, work,
              [&](const hs_columns& some, std::size_t first, std::size_t) {
                if (queries.order.empty()) {
                  find(some, first, to + first * each);
                  return;
                }
                const auto its = std::make_unique<Value[]>(some.count * each);
                find(some, first, its.get());
                for (std::size_t i = 0; i < some.count; ++i) {
                  std::copy_n(its.get() + i * each, each,
                              to + queries.order[first + i] * each);
                }
              });
  work.Finish();
  return values;
}

// The numbers of hs_bvh_count() or hs_scan_counts(), or the ids of hs_bvh_any()
// or hs_scan_any(), and those of broad phases.
template <typename Object, typename Options, typename Value>
pybind11::array_t<Value> AskEach(const Object* object,
                                 hs_status (*function)(const Object*,
                                                       const hs_columns*,
                                                       const Options*, Value*),
                                 const Columns& queries, std::size_t in_part,
                                 Work& work, const Options* options = nullptr) {
  return FindEach<Value>(
      queries, 1, in_part, work,
      [&](const hs_columns& some, std::size_t, Value* values) {
        Check(function(object, &some, options, values));
      });
}

// Returns the ids and the floats that find(some, first, ids, floats) writes for
// the queries of a part, in arrays of shape (queries, each). -1 instead of
// HS_NO_ID.
template <typename Find>
pybind11::tuple FindIdsAndFloats(const Columns& queries, std::size_t each,
                                 std::size_t in_part, Work& work,
                                 const Find& find) {
  const std::vector<std::size_t> shape{queries.count, each};
  pybind11::array_t<float> floats(shape);
  Ids ids(shape);
  float* const all_floats = floats.mutable_data();
  std::int64_t* const all_ids = ids.mutable_data();
  ForEachPart(queries, in_part, work,
              [&](const hs_columns& some, std::size_t first, std::size_t) {
                std::vector<std::uint32_t> its_ids(some.count * each);
                std::vector<float> its_floats(some.count * each);
                find(some, first, its_ids.data(), its_floats.data());
                for (std::size_t i = 0; i < some.count; ++i) {
                  const std::size_t at = queries.RowAt(first + i) * each;
                  std::copy_n(&its_floats[i * each], each, all_floats + at);
                  std::transform(&its_ids[i * each], &its_ids[i * each] + each,
                                 all_ids + at, [](std::uint32_t id) {
                                   return id == HS_NO_ID ? -1
                                                         : std::int64_t{id};
                                 });
                }
              });
  work.Finish();
  return pybind11::make_tuple(ids, floats);
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_RESULTS_H_
