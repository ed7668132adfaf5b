// The queries of a call in parts, on several threads, and their results as
// NumPy arrays. Each part finds a list, whose length is known only at its end.
#ifndef HALFSPACE_PYTHON_RESULTS_H_
#define HALFSPACE_PYTHON_RESULTS_H_

#include <halfspace/c/halfspace.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
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

// The queries of a part, which are at the places from `first` on of their
// order.
struct QueryPart {
  hs_columns queries;
  std::size_t first;
  std::size_t thread;
};

// Calls run(part) for each part, without the interpreter's lock.
template <typename Run>
void ForEachPart(const Columns& queries, std::size_t in_part, Work& work,
                 const Run& run) {
  const pybind11::gil_scoped_release release;
  work.SetStage(0, queries.count, queries.count);
  work.Run(PartsOf(queries.count, in_part),
           [&](std::size_t part, std::size_t thread) {
             const std::size_t first = part * in_part;
             std::vector<std::byte> copy;
             run(QueryPart{queries.Part(first, in_part, copy), first, thread});
           });
}

// A distance or the t of a hit, and its object.
struct Found {
  auto operator<=>(const Found&) const = default;

  float value;
  std::uint32_t id;
};

// Loads a cache line ahead of its use, if the compiler has a way to ask for it.
inline void Prefetch([[maybe_unused]] const void* at) {
#if defined(__GNUC__)
  __builtin_prefetch(at);
#endif
}

// Returns the rows and the ids, of shape (2, n), and the values of the items,
// if they have one. The results of the query at place i end at ends[i] of the
// list of its part.
template <typename Item>
std::pair<Ids, pybind11::array_t<float>> Gather(
    const std::vector<std::vector<Item>>& lists,
    const std::vector<std::size_t>& ends, const Columns& queries,
    std::size_t in_part, Work& work) {
  constexpr bool kHasValues = std::is_same_v<Item, Found>;
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
  pybind11::array_t<float> values(Size(kHasValues ? total : 0));
  std::int64_t* const rows = ids.mutable_data();
  [[maybe_unused]] float* const to = values.mutable_data();
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
        Prefetch(found[row + kAhead].items);
      }
      const Item* item = found[row].items;
      std::fill(rows + at, rows + found[row].end,
                static_cast<std::int64_t>(row));
      for (; at < found[row].end; ++at, ++item) {
        if constexpr (kHasValues) {
          rows[total + at] = item->id;
          to[at] = item->value;
        } else {
          rows[total + at] = *item;
        }
      }
    }
  });
  work.Finish();
  return {std::move(ids), std::move(values)};
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
  ForEachPart(queries, in_part, work, [&](const QueryPart& part) {
    std::array<std::size_t, kPartQueries + 1> offsets;
    results.Add(part.first / in_part, part.thread,
                [&](std::span<std::uint32_t> ids) {
                  return find(part.queries, ids, offsets.data());
                });
    std::copy_n(offsets.data() + 1, part.queries.count,
                ends.data() + part.first);
  });
  return Gather(results.lists, ends, queries, in_part, work).first;
}

// Returns the rows and the ids, of shape (2, n), and the values.
// find(part, list, ends) appends to the list of a part, and writes where the
// results of each of its queries end.
template <typename Find>
pybind11::tuple FindLists(const Columns& queries, std::size_t in_part,
                          Work& work, const Find& find) {
  std::vector<std::vector<Found>> lists(PartsOf(queries.count, in_part));
  std::vector<std::size_t> ends(queries.count);
  ForEachPart(queries, in_part, work, [&](const QueryPart& part) {
    find(part, lists[part.first / in_part], ends.data() + part.first);
  });
  const auto [ids, values] = Gather(lists, ends, queries, in_part, work);
  return pybind11::make_tuple(ids, values);
}

// An array of shape (n, 2).
inline Ids ToArray(const std::vector<hs_id_pair>& pairs) {
  Ids ids(std::vector<std::size_t>{pairs.size(), 2});
  static_assert(sizeof(hs_id_pair) == 2 * sizeof(std::uint32_t));
  std::copy_n(reinterpret_cast<const std::uint32_t*>(pairs.data()),
              2 * pairs.size(), ids.mutable_data());
  return ids;
}

// A result as Python has it: -1 instead of HS_NO_ID.
template <typename Value>
auto ResultOf(Value value) {
  if constexpr (std::is_integral_v<Value>) {
    return value == HS_NO_ID ? -1 : static_cast<std::int64_t>(value);
  } else {
    return value;
  }
}

// An array of shape (queries, each), which the parts of a call write.
template <typename Value>
class Output {
 public:
  Output(const Columns& queries, std::size_t each)
      : queries_(queries),
        each_(each),
        array_(std::vector<std::size_t>{queries.count, each}),
        to_(array_.mutable_data()) {}

  // Stores the values of the queries at the places from `first` on.
  void Store(std::size_t first, const std::vector<Value>& values) const {
    const Value* const end = values.data() + values.size();
    for (const Value* from = values.data(); from != end; from += each_) {
      std::transform(from, from + each_, to_ + queries_.RowAt(first++) * each_,
                     &ResultOf<Value>);
    }
  }
  const auto& array() const { return array_; }

 private:
  using Result = decltype(ResultOf(Value()));

  const Columns& queries_;
  std::size_t each_;
  pybind11::array_t<Result> array_;
  Result* to_;
};

// Returns what find(queries, values) writes for the queries of a part, one
// value for each, as an array of shape (queries, 1).
template <typename Value, typename Find>
pybind11::array FindEach(const Columns& queries, std::size_t in_part,
                         Work& work, const Find& find) {
  const Output<Value> output(queries, 1);
  ForEachPart(queries, in_part, work, [&](const QueryPart& part) {
    std::vector<Value> values(part.queries.count);
    find(part.queries, values.data());
    output.Store(part.first, values);
  });
  work.Finish();
  return output.array();
}

// Returns the ids and the floats that find(part, ids, floats) writes for the
// queries of a part, in arrays of shape (queries, each).
template <typename Find>
pybind11::tuple FindIdsAndFloats(const Columns& queries, std::size_t each,
                                 std::size_t in_part, Work& work,
                                 const Find& find) {
  const Output<std::uint32_t> ids(queries, each);
  const Output<float> floats(queries, each);
  ForEachPart(queries, in_part, work, [&](const QueryPart& part) {
    std::vector<std::uint32_t> its_ids(part.queries.count * each);
    std::vector<float> its_floats(part.queries.count * each);
    find(part, its_ids.data(), its_floats.data());
    ids.Store(part.first, its_ids);
    floats.Store(part.first, its_floats);
  });
  work.Finish();
  return pybind11::make_tuple(ids.array(), floats.array());
}

// Which of two functions of C has this last output.
template <typename Of>
constexpr bool kFindsAll = std::is_same_v<Of, void*>;

// The hits of the casts of a part.
struct Hits {
  std::vector<Found>* list;
  std::size_t* ends;

  // A hs_hit_function.
  static float Add(void* hits, std::size_t cast, std::uint32_t id, float t) {
    const auto& its = *static_cast<Hits*>(hits);
    its.list->push_back({t, id});
    its.ends[cast] = its.list->size();
    return std::numeric_limits<float>::infinity();
  }
};

// The first hits or, sorted by t, all hits of casts. cast(part, ids, ts) writes
// the first ones of a part, and cast(part, function, context) calls a function
// for all of them.
template <typename Call>
pybind11::tuple FindHits(const Columns& queries, bool finds_all, Work& work,
                         const Call& cast) {
  if (!finds_all) return FindIdsAndFloats(queries, 1, kPartQueries, work, cast);
  return FindLists(
      queries, kPartQueries, work,
      [&](const QueryPart& part, std::vector<Found>& list, std::size_t* ends) {
        Hits hits{&list, ends};
        cast(part, &Hits::Add, static_cast<void*>(&hits));
        for (std::size_t i = 0, begin = 0; i < part.queries.count; ++i) {
          ends[i] = std::max(begin, ends[i]);
          std::sort(list.data() + begin, list.data() + ends[i]);
          begin = ends[i];
        }
      });
}

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_RESULTS_H_
