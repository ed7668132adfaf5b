// The BVH.
#include <pybind11/numpy.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Leaves of one part of a join.
constexpr std::size_t kPartLeaves = 16;

using Bvh = std::unique_ptr<hs_bvh, Destroy<&hs_bvh_destroy>>;

// Calls run without the interpreter's lock, so another thread can call the same
// object. Its members are read and written with the lock.
struct Tree {
  py::object blob;  // the bytes, if they are in place
  Bvh bvh;
  std::size_t dims = 3;
  std::vector<unsigned long> readers;  // the threads of calls that read now
  unsigned long changer = 0;           // the thread of the call that changes it
  unsigned long owner = 0;             // the thread that called Own()
  std::size_t owned = 0;               // how often
  bool owner_waits = false;            // for the calls that run
  std::size_t exports = 0;             // blobs that Python objects refer to
  bool is_half_refitted = false;       // an exception ended Refit()
  std::size_t changes = 0;             // so far

  bool IsReadBy(unsigned long thread) const {
    return std::find(readers.begin(), readers.end(), thread) != readers.end();
  }
  // Whether a call of the thread waits. One that is inside of another, in a
  // function of the caller's, does not: the owner waits for the other.
  bool IsClosedTo(unsigned long thread) const {
    return owner != 0 && owner != thread && changer != thread &&
           !IsReadBy(thread);
  }
};

// Sleeps until a thread calls WakeAll(). Ctrl-C ends it.
struct Waiters {
  std::mutex mutex;
  std::condition_variable condition;
  std::size_t wakes = 0;

  template <typename Condition>
  void WaitUntil(const Condition& holds) {
    while (!holds()) {
      const std::size_t seen = wakes;  // changes with the interpreter's lock
      {
        const py::gil_scoped_release release;
        std::unique_lock lock(mutex);
        condition.wait_for(lock, std::chrono::milliseconds(50),
                           [&] { return wakes != seen; });
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }

  void WakeAll() {
    const std::scoped_lock lock(mutex);
    ++wakes;
    condition.notify_all();
  }
};

Waiters& TheWaiters() {
  static Waiters waiters;
  return waiters;
}

// For both at the same time, so that nobody waits for a call that waits.
void WaitUntilOpen(const Tree& tree, const Tree& other) {
  if (tree.owner == 0 && other.owner == 0) return;
  const unsigned long self = PyThread_get_thread_ident();
  TheWaiters().WaitUntil(
      [&] { return !tree.IsClosedTo(self) && !other.IsClosedTo(self); });
}
void WaitUntilOpen(const Tree& tree) { WaitUntilOpen(tree, tree); }

void CheckRefitted(const Tree& tree) {
  if (!tree.is_half_refitted) return;
  throw std::runtime_error(
      "refit() of this BVH was interrupted: call refit() with all boxes again "
      "before any other call");
}

// Exists while a call reads a tree. The constructor waits for the owner, and
// throws if another call changes the tree.
struct Reading {
  explicit Reading(Tree& its_tree, bool is_refit = false) : tree(its_tree) {
    WaitUntilOpen(tree);
    if (tree.changer != 0) {
      throw std::runtime_error(
          "another call is changing this BVH: wait until it has finished");
    }
    if (!is_refit) CheckRefitted(tree);
    tree.readers.push_back(thread);
  }
  Reading(const Reading&) = delete;
  ~Reading() {
    // Those of one thread are equal.
    *std::find(tree.readers.begin(), tree.readers.end(), thread) =
        tree.readers.back();
    tree.readers.pop_back();
    if (tree.owner_waits && tree.readers.empty()) TheWaiters().WakeAll();
  }

  Tree& tree;
  unsigned long thread = PyThread_get_thread_ident();
};

void Disown(Tree& tree) {
  if (--tree.owned != 0) return;
  tree.owner = 0;
  TheWaiters().WakeAll();
}

// Makes all other threads wait, and waits for the calls that run now.
void Own(Tree& tree) {
  const unsigned long self = PyThread_get_thread_ident();
  if (tree.changer == self || tree.IsReadBy(self)) {
    throw std::runtime_error(
        "changing() was called inside of a call of the same BVH");
  }
  WaitUntilOpen(tree);
  tree.owner = self;
  ++tree.owned;
  tree.owner_waits = true;
  try {
    TheWaiters().WaitUntil(
        [&] { return tree.readers.empty() && tree.changer == 0; });
    tree.owner_waits = false;
  } catch (...) {
    tree.owner_waits = false;
    Disown(tree);
    throw;
  }
}

// Calls change() without the interpreter's lock. Waits for the owner. Throws if
// another call uses the tree, or if Python objects refer to its blob.
template <typename Function>
void Change(Tree& tree, const Function& change, bool is_refit = false) {
  WaitUntilOpen(tree);
  if (tree.changer != 0 || !tree.readers.empty()) {
    throw std::runtime_error(
        "another call is using this BVH: wait until it has finished before "
        "you change the BVH, or change it in `with tree.changing():`");
  }
  if (tree.exports > 0) {
    throw py::buffer_error(
        "the blob of this BVH is in use: release it before you change the BVH");
  }
  if (!is_refit) CheckRefitted(tree);
  const auto end = [](Tree* its) {
    its->changer = 0;
    if (its->owner_waits) TheWaiters().WakeAll();
  };
  const std::unique_ptr<Tree, decltype(end)> changing(&tree, end);
  tree.changer = PyThread_get_thread_ident();
  if (is_refit) ++tree.changes;  // also if an exception ends it
  {
    const py::gil_scoped_release release;
    change();
  }
  if (!is_refit) ++tree.changes;
}

// With the interpreter's lock: a refit does not change sizes.
template <hs_status (*kSize)(const hs_bvh*, std::size_t*)>
std::size_t Ask(Tree& tree) {
  const Reading reading(tree, /*is_refit=*/true);
  std::size_t size = 0;
  Check(kSize(tree.bvh.get(), &size));
  return size;
}

hs_bvh_config ConfigOf(std::size_t dims) {
  hs_bvh_config config = DefaultOf(&hs_bvh_config_default);
  config.kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  return config;
}

Bvh Build(const Columns& boxes, bool is_fast, Work& work,
          std::size_t progress_end) {
  const bool is_double = boxes.type == HS_FLOAT64;
  // Doubles are rounded, then centers, six splits, a sort and a copy; or
  // centers and a copy.
  Threads threads{work, (is_double ? 1u : 0u) + (is_fast ? 2u : 9u),
                  progress_end, boxes.count};
  hs_bvh_config config = ConfigOf(boxes.size == 4 ? 2 : 3);
  config.quality = is_fast ? HS_QUALITY_FAST : HS_QUALITY_HIGH;
  config.run = &Threads::Run;
  config.run_context = &threads;
  hs_bvh* bvh = nullptr;
  threads.Check(hs_bvh_create(&config, &boxes, &bvh));
  return Bvh(bvh);
}

std::unique_ptr<Tree> MakeTree(const py::tuple& arrays, bool is_fast,
                               std::size_t threads, py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  auto tree = std::make_unique<Tree>();
  tree->dims = boxes.size == 4 ? 2 : 3;
  const py::gil_scoped_release release;
  tree->bvh = Build(boxes, is_fast, work, boxes.count);
  // A BVH that never had an object has an empty blob, from which nobody could
  // tell its dimensions. One with room has a header.
  if (boxes.count == 0) Check(hs_bvh_reserve(tree->bvh.get(), 1));
  work.SetStage(0, 0, boxes.count);
  work.Finish();
  return tree;
}

// In place if the bytes are aligned, and else a copy. `blob` is an array of
// bytes.
std::unique_ptr<Tree> FromBlob(const py::array_t<std::uint8_t>& blob,
                               bool verify) {
  constexpr std::size_t kAlignment = 64;
  const std::uint8_t* const bytes = blob.data();
  const auto size = static_cast<std::size_t>(blob.size());
  if (size == 0) throw std::invalid_argument("the blob is empty");
  auto tree = std::make_unique<Tree>();
  if (reinterpret_cast<std::uintptr_t>(bytes) % kAlignment == 0) {
    tree->blob = blob;
  }
  const py::gil_scoped_release release;
  // If this fails, the next call says why.
  hs_kind kind = HS_BOX3;
  hs_blob_kind(bytes, size, &kind);
  tree->dims = kind == HS_BOX2 ? 2 : 3;
  const hs_bvh_config config = ConfigOf(tree->dims);
  hs_bvh* bvh = nullptr;
  const hs_status status = hs_bvh_in_place(&config, bytes, size, &bvh);
  if (status == HS_CORRUPT) {
    // Without the name of the argument, as the caller has another.
    throw std::invalid_argument(hs_last_error_reason());
  }
  Check(status);
  tree->bvh.reset(bvh);
  if (verify && hs_bvh_verify(tree->bvh.get()) != HS_OK) {
    throw std::invalid_argument(
        "the blob was altered: its checksum does not match its bytes");
  }
  return tree;
}

// The bytes of a tree as an array. A tree with such an array refuses changes.
py::array BlobOf(const py::object& object) {
  auto& tree = object.cast<Tree&>();
  const Reading reading(tree);
  const void* data = nullptr;
  std::size_t size = 0;
  {
    const py::gil_scoped_release release;
    Check(hs_bvh_blob(tree.bvh.get(), &data, &size));
  }
  const py::capsule owner(new py::object(object), [](void* of) {
    const std::unique_ptr<py::object> its(static_cast<py::object*>(of));
    --its->cast<Tree&>().exports;
  });
  ++tree.exports;
  py::array_t<std::uint8_t> bytes(
      Size(size), static_cast<const std::uint8_t*>(data), owner);
  bytes.attr("setflags")(false);  // not to be written
  return bytes;
}

// Finds the pairs of a tree, and of `b` or of itself if this is null, by part.
// Call it without the interpreter's lock.
Results<hs_id_pair> FindPairs(const hs_bvh* a, const hs_bvh* b, Work& work) {
  std::size_t leaves = 0;
  Check(hs_bvh_pair_parts(a, &leaves));
  const std::size_t parts = PartsOf(leaves, kPartLeaves);
  std::size_t size = 0;
  Check(hs_bvh_size(a, &size));
  work.SetStage(0, size, size);
  Results<hs_id_pair> results(parts, work.threads(), 4096);
  work.Run(parts, [&](std::size_t part, std::size_t thread) {
    hs_pair_options options = DefaultOf(&hs_pair_options_default);
    options.begin = part * kPartLeaves;
    options.end = options.begin + kPartLeaves;
    results.Add(part, thread, [&](std::span<hs_id_pair> pairs) {
      std::size_t total = 0;
      Check(b == nullptr
                ? hs_bvh_pairs(a, &options, pairs.data(), pairs.size(), &total)
                : hs_bvh_join(a, b, &options, pairs.data(), pairs.size(),
                              &total));
      return total;
    });
  });
  return results;
}

// Sorts the queries into a tree of their own and joins the trees: queries that
// are near each other share what they read. Then sorts the pairs by row.
Ids QueryByJoin(const Tree& tree, const Columns& boxes, Work& work) {
  const auto results = [&] {
    const py::gil_scoped_release release;
    const Bvh queries = Build(boxes, /*is_fast=*/true, work,
                              /*progress_end=*/0);
    return FindPairs(queries.get(), tree.bvh.get(), work);
  }();
  const std::size_t parts = results.lists.size();
  std::vector<std::size_t> ends(boxes.count);
  {
    const py::gil_scoped_release release;
    work.SetLastStage();
    // All pairs of a row are in one part.
    work.Run(parts, [&](std::size_t part, std::size_t) {
      for (const hs_id_pair& pair : results.lists[part]) ++ends[pair.a];
    });
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
  }
  Ids ids = RowsOf(ends, work);
  std::int64_t* const objects = ids.mutable_data() + ids.shape(1);
  const py::gil_scoped_release release;
  work.Run(parts, [&](std::size_t part, std::size_t) {
    for (const hs_id_pair& pair : results.lists[part]) {
      objects[--ends[pair.a]] = pair.b;
    }
  });
  return ids;
}

// Queries of boxes, of spheres, or of boxes with a distance.
Ids Query(Tree& tree, const py::tuple& arrays, bool by_join,
          std::size_t threads, py::object progress) {
  const Columns queries(arrays);
  hs_query_options options = DefaultOf(&hs_query_options_default);
  if (queries.size == tree.dims + 1) options.shape = HS_SHAPE_SPHERE;
  if (queries.size == 2 * tree.dims + 1) options.shape = HS_SHAPE_ROUNDED_BOX;
  Work work(threads, std::move(progress));
  const Reading reading(tree);
  Ids ids = by_join
                ? QueryByJoin(tree, queries, work)
                : FindAll(queries, kPartQueries, work,
                          FinderOf(tree.bvh.get(), &hs_bvh_query, &options));
  work.Finish();
  return ids;
}

py::object QueryOne(Tree& tree, const py::array& array) {
  const Reading reading(tree);
  return FindOfOne(array, tree.dims, FinderOf(tree.bvh.get(), &hs_bvh_query));
}

// Returns an array with at most `limit` ids of one query, after the first
// `skip`, and the number of all ids.
py::tuple QuerySome(Tree& tree, const py::tuple& arrays, std::size_t skip,
                    std::size_t limit) {
  const Columns boxes(arrays);
  hs_query_options options = DefaultOf(&hs_query_options_default);
  options.skip = skip;
  ShortIds ids(Size(limit));
  std::uint32_t* const to = ids.mutable_data();
  std::size_t total = 0;
  {
    const Reading reading(tree);
    const py::gil_scoped_release release;
    Check(hs_bvh_query(tree.bvh.get(), &boxes, &options, to, limit, nullptr,
                       &total));
  }
  return py::make_tuple(ids, total);
}

// hs_bvh_count() or hs_bvh_any().
template <auto kFunction>
py::array AskAll(Tree& tree, const py::tuple& arrays, std::size_t threads,
                 py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  const Reading reading(tree);
  return AskEach(tree.bvh.get(), kFunction, boxes, kPartQueries, work);
}

// The same of the box of a plain array, as QueryOne().
template <auto kFunction, typename Value>
py::object AskOne(Tree& tree, const py::array& array) {
  const hs_columns box = BoxIn(array, tree.dims);
  if (box.count == 0) return py::none();
  Value value = 0;
  const Reading reading(tree);
  {
    const py::gil_scoped_release release;
    Check(kFunction(tree.bvh.get(), &box, nullptr, &value));
  }
  return py::int_(value);
}

py::tuple Nearest(Tree& tree, const py::tuple& arrays, std::size_t k,
                  float max_distance, bool is_exclusive, std::size_t threads,
                  py::object progress) {
  const Columns queries(arrays);
  const bool are_points = queries.size == tree.dims;
  const auto nearest =
      are_points ? &hs_bvh_nearest_to_points : &hs_bvh_nearest_to_boxes;
  hs_query_options options = DefaultOf(&hs_query_options_default);
  options.exclusive = is_exclusive ? 1 : 0;
  Work work(threads, std::move(progress));
  const Reading reading(tree);
  return FindNearest(tree.bvh.get(), nearest, queries, k, max_distance, options,
                     work);
}

py::tuple Cast(Tree& tree, const py::tuple& starts, const py::tuple& motions,
               std::size_t threads, py::object progress) {
  Work work(threads, std::move(progress));
  const Reading reading(tree);
  return FindFirst<&hs_bvh_raycast, &hs_bvh_boxcast, &hs_bvh_spherecast>(
      tree.bvh.get(), tree.dims, Columns(starts), Columns(motions),
      DefaultOf(&hs_query_options_default), work);
}

// The pairs of a tree and of `b`, or of itself if this is null, in an array of
// shape (2, n). Those of one tree have i < j.
Ids PairsOf(Tree& tree, Tree* b, std::size_t threads, py::object progress) {
  Work work(threads, std::move(progress));
  const auto results = [&] {
    WaitUntilOpen(tree, b == nullptr ? tree : *b);
    const Reading reading(tree);
    const Reading reading_b(b == nullptr ? tree : *b);
    const py::gil_scoped_release release;
    return FindPairs(tree.bvh.get(), b == nullptr ? nullptr : b->bvh.get(),
                     work);
  }();
  const std::vector<std::size_t> offsets = results.Offsets();
  const std::size_t found = offsets.back();
  Ids ids(std::vector<std::size_t>{2, found});
  std::int64_t* const to = ids.mutable_data();
  work.SetLastStage();
  const py::gil_scoped_release release;
  work.Run(results.lists.size(), [&](std::size_t part, std::size_t) {
    std::size_t at = offsets[part];
    for (hs_id_pair pair : results.lists[part]) {
      if (b == nullptr && pair.b < pair.a) std::swap(pair.a, pair.b);
      to[at] = pair.a;
      to[found + at] = pair.b;
      ++at;
    }
  });
  work.Finish();
  return ids;
}

ShortIds Insert(Tree& tree, const py::tuple& arrays) {
  const Columns boxes(arrays);
  ShortIds ids(Size(boxes.count));
  std::uint32_t* const to = ids.mutable_data();
  Change(tree, [&] { Check(hs_bvh_insert(tree.bvh.get(), &boxes, to)); });
  return ids;
}

void Erase(Tree& tree, const ShortIds& ids) {
  Change(tree, [&] {
    Check(hs_bvh_erase(tree.bvh.get(), ids.data(),
                       static_cast<std::size_t>(ids.size())));
  });
}

void Refit(Tree& tree, const py::tuple& arrays, std::size_t threads,
           py::object progress) {
  const Columns boxes(arrays);
  Work work(threads, std::move(progress));
  // A refit of doubles rounds first.
  Threads its_threads{work, boxes.type == HS_FLOAT64 ? 2u : 1u, boxes.count,
                      boxes.count};
  const auto refit = [&] {
    tree.is_half_refitted = true;
    its_threads.Check(
        hs_bvh_refit(tree.bvh.get(), &boxes, &Threads::Run, &its_threads));
    tree.is_half_refitted = false;
    work.Finish();
  };
  Change(tree, refit, /*is_refit=*/true);
}

// hs_bvh_set() or hs_bvh_insert_as().
template <auto kFunction>
void SetSome(Tree& tree, const py::tuple& arrays, const ShortIds& ids) {
  const Columns boxes(arrays);
  if (Size(boxes.count) != ids.size()) ThrowNotPrepared();
  Change(tree, [&] { Check(kFunction(tree.bvh.get(), ids.data(), &boxes)); });
}

py::array_t<float> BoundsOf(Tree& tree) {
  const Reading reading(tree);
  py::array_t<float> values(Size(2 * tree.dims));
  Check(hs_bvh_bounds(tree.bvh.get(), values.mutable_data()));
  return values;
}

// The boxes by id, one after another; that of no object is empty.
py::array_t<float> Boxes(Tree& tree) {
  const Reading reading(tree);
  std::size_t count = 0;
  Check(hs_bvh_id_limit(tree.bvh.get(), &count));
  py::array_t<float> values(std::vector<std::size_t>{count, 2 * tree.dims});
  float* const to = values.mutable_data();
  const py::gil_scoped_release release;
  Check(hs_bvh_get_all(tree.bvh.get(), to, count));
  return values;
}

}  // namespace

void DefineTree(py::module_& module) {
  py::class_<Tree>(module, "Tree")
      .def(py::init(&MakeTree))
      .def_static("from_blob", &FromBlob)
      .def("query", &Query)
      .def("query_one", &QueryOne)
      .def("query_some", &QuerySome)
      .def("blob", &BlobOf)
      .def("count", &AskAll<&hs_bvh_count>)
      .def("count_one", &AskOne<&hs_bvh_count, std::size_t>)
      .def("any", &AskAll<&hs_bvh_any>)
      .def("any_one", &AskOne<&hs_bvh_any, std::uint32_t>)
      .def("nearest", &Nearest)
      .def("cast", &Cast)
      .def("pairs", &PairsOf)
      .def("insert", &Insert)
      .def("insert_as", &SetSome<&hs_bvh_insert_as>)
      .def("erase", &Erase)
      .def("refit", &Refit)
      .def("refit_some", &SetSome<&hs_bvh_set>)
      .def("own", &Own)
      .def("disown", &Disown)
      .def("bounds", &BoundsOf)
      .def("boxes", &Boxes)
      .def("size", &Ask<&hs_bvh_size>)
      .def("id_limit", &Ask<&hs_bvh_id_limit>)
      .def("nbytes", &Ask<&hs_bvh_bytes>)
      .def_readonly("dims", &Tree::dims)
      .def_readonly("changes", &Tree::changes);
}

}  // namespace halfspace::python
