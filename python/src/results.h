// The queries of a call in parts, on several threads, and their results as
// NumPy arrays. Each part finds a list, whose length is known only at its end.
#ifndef HALFSPACE_PYTHON_RESULTS_H_
#define HALFSPACE_PYTHON_RESULTS_H_

#include <halfspace/c/halfspace.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
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

// Returns where the items of each part begin in the list of all items, and then
// the number of all items.
template <typename Item>
std::vector<std::size_t> OffsetsOf(
    const std::vector<std::vector<Item>>& lists) {
  std::vector<std::size_t> offsets{0};
  offsets.reserve(lists.size() + 1);
  for (const auto& list : lists)
    offsets.push_back(offsets.back() + list.size());
  return offsets;
}

// Calls run(some, first, thread) for the queries of each part, of which `first`
// is the first, without the interpreter's lock.
template <typename Run>
void ForEachPart(const Columns& queries, std::size_t in_part, Work& work,
                 const Run& run) {
  const pybind11::gil_scoped_release release;
  work.SetStage(0, queries.count, queries.count);
  work.Run(PartsOf(queries.count, in_part),
           [&](std::size_t part, std::size_t thread) {
             const std::size_t first = part * in_part;
             run(queries.Rows(first, in_part), first, thread);
           });
}

// Returns an array of shape (2, n) whose first row is filled: the numbers of
// the queries, where the results of query i end at ends[i].
inline Ids RowsOf(const std::vector<std::size_t>& ends, Work& work) {
  constexpr std::size_t kInPart = 65536;
  const std::size_t found = ends.empty() ? 0 : ends.back();
  Ids ids(std::vector<std::size_t>{2, found});
  std::int64_t* const rows = ids.mutable_data();
  const pybind11::gil_scoped_release release;
  work.SetLastStage();
  work.Run(PartsOf(ends.size(), kInPart), [&](std::size_t part, std::size_t) {
    std::size_t i = part * kInPart;
    const std::size_t end = std::min(ends.size(), i + kInPart);
    for (std::size_t at = i == 0 ? 0 : ends[i - 1]; i < end; at = ends[i++]) {
      std::fill(rows + at, rows + ends[i], static_cast<std::int64_t>(i));
    }
  });
  return ids;
}

// Returns the rows and the ids, of shape (2, n). write(item, i) writes the rest
// of an item and returns its id. The results of query i end at ends[i] of the
// list of its part. prepare(n) runs before write().
template <typename Item, typename Prepare, typename Write>
Ids Gather(const std::vector<std::vector<Item>>& lists,
           std::vector<std::size_t>& ends, std::size_t in_part, Work& work,
           const Prepare& prepare, const Write& write) {
  const std::vector<std::size_t> offsets = OffsetsOf(lists);
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i] += offsets[i / in_part];
  Ids ids = RowsOf(ends, work);
  prepare(offsets.back());
  std::int64_t* const objects = ids.mutable_data() + offsets.back();
  const pybind11::gil_scoped_release release;
  work.Run(lists.size(), [&](std::size_t part, std::size_t) {
    std::size_t i = offsets[part];
    for (const Item& item : lists[part]) {
      objects[i] = write(item, i);
      ++i;
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
      results.lists, ends, in_part, work, [](std::size_t) {},
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
      lists, ends, in_part, work,
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
                find(some, first, to + first * each);
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
  float* const to = floats.mutable_data();
  const auto found = FindEach<std::uint32_t>(
      queries, each, in_part, work,
      [&](const hs_columns& some, std::size_t first, std::uint32_t* its_ids) {
        find(some, first, its_ids, to + first * each);
      });
  std::transform(
      found.data(), found.data() + found.size(), ids.mutable_data(),
      [](std::uint32_t id) { return id == HS_NO_ID ? -1 : std::int64_t{id}; });
  return pybind11::make_tuple(ids, floats);
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_RESULTS_H_
