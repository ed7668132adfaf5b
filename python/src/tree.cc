// The BVH.
#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "searches.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Leaves of one part of a join.
constexpr std::size_t kPartLeaves = 16;

using Bvh = std::unique_ptr<hs_bvh, Destroy<&hs_bvh_destroy>>;

// Writes record i as doubles.
void ReadRow(const hs_columns& columns, std::size_t i, std::size_t size,
             double* row) {
  for (std::size_t v = 0; v < size; ++v) {
    const std::size_t at = i * columns.stride;
    row[v] = columns.type == HS_FLOAT64
                 ? static_cast<const double*>(columns.column[v])[at]
                 : static_cast<const float*>(columns.column[v])[at];
  }
}

// Writes all records, one after another, or each at the place of its id.
void ReadRows(const Columns& boxes, const std::uint32_t* ids, double* rows) {
  for (std::size_t i = 0; i < boxes.count; ++i) {
    ReadRow(boxes, i, boxes.size,
            rows + boxes.size * (ids == nullptr ? i : ids[i]));
  }
}

// Boxes by id. An altered blob has any ids.
struct Rows {
  const double* Find(std::uint32_t id) const {
    const std::size_t first = 2 * dims * id;
    return first < values.size() ? values.data() + first : nullptr;
  }
  // Whether the object is there, at most `margin` from a box on each axis, or
  // if `is_round` by the Euclidean distance, whose error is below 2^-50.
  bool IsNear(std::uint32_t id, const double* box, double margin,
              bool is_round = false) const {
    const double* const row = Find(id);
    if (row == nullptr || box == nullptr) return false;
    bool is_near = true;
    for (std::size_t k = 0; k < dims; ++k) {
      is_near &=
          row[k] <= box[dims + k] + margin && box[k] <= row[dims + k] + margin;
    }
    if (!is_near || !is_round) return is_near;
    double squares = 0;
    for (std::size_t k = 0; k < dims; ++k) {
      // 0 if both are infinite: max() returns its first argument, not NaN.
      const double gap = std::max(std::max(0.0, row[k] - box[dims + k]),
                                  box[k] - row[dims + k]);
      squares += gap * gap;
    }
    return squares <= margin * margin * (1 + 0x1p-50);
  }
  // Without it, most of the time is spent waiting for memory.
  void Prefetch(std::uint32_t id) const {
    const double* const row = Find(id);
    if (row == nullptr) return;
    python::Prefetch(row);
    python::Prefetch(row + 2 * dims - 1);
  }

  std::span<const double> values;
  std::size_t dims;
};
constexpr std::size_t kAhead = 16;

// Removes the pairs whose boxes are farther apart than the margin. Returns how
// many are left.
std::size_t KeepNear(const Rows& a, const Rows& b, double margin, bool is_round,
                     std::span<hs_id_pair> pairs) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i + kAhead < pairs.size()) {
      a.Prefetch(pairs[i + kAhead].a);
      b.Prefetch(pairs[i + kAhead].b);
    }
    const hs_id_pair pair = pairs[kept] = pairs[i];
    kept += b.IsNear(pair.b, a.Find(pair.a), margin, is_round) ? 1 : 0;
  }
  return kept;
}

// Calls run without the interpreter's lock, so another thread can call the same
// object. Its members are read and written with the lock.
struct TreeReading;
struct Tree {
  using Functions = BvhFunctions;
  using Reading = TreeReading;
  static constexpr std::size_t kPart = kPartQueries;
  static constexpr bool kCanBeExact = true;

  py::object blob;  // the bytes, if they are in place
  Bvh bvh;
  std::size_t dims = 3;
  bool is_exact = false;             // `doubles` decide
  std::vector<double> doubles;       // the boxes by id, one after another
  std::vector<unsigned long> users;  // the threads of calls that run now
  bool is_changing = false;          // by the only one of them
  unsigned long owner = 0;           // the thread that called Own()
  std::size_t owned = 0;             // how often
  bool owner_waits = false;          // for the calls that run
  std::size_t waiting = 0;           // calls that wait for the owner
  std::size_t exports = 0;           // blobs and pickles in use
  bool is_half_refitted = false;     // an exception ended Refit()
  std::size_t changes = 0;           // so far

  hs_bvh* get() const { return bvh.get(); }
  static hs_columns QueryOf(const hs_columns& box, float* /*unused*/) {
    return box;
  }

  Rows rows() const { return {doubles, dims}; }
  // Removes the results that do not overlap as doubles. Those of query q end at
  // offsets[q + 1].
  std::size_t Keep(const hs_columns& queries, std::span<std::uint32_t> ids,
                   std::size_t* offsets) const {
    std::array<std::size_t, 2> of_one{0, ids.size()};
    if (offsets == nullptr) offsets = of_one.data();
    std::size_t kept = 0;
    for (std::size_t q = 0, i = 0; q < queries.count; ++q) {
      std::array<double, 6> box;
      ReadRow(queries, q, 2 * dims, box.data());
      for (const std::size_t end = offsets[q + 1]; i < end; ++i) {
        if (i + kAhead < ids.size()) rows().Prefetch(ids[i + kAhead]);
        ids[kept] = ids[i];
        kept += rows().IsNear(ids[kept], box.data(), 0) ? 1 : 0;
      }
      offsets[q + 1] = kept;
    }
    return kept;
  }
  void KeepPairs(float margin, std::vector<hs_id_pair>& pairs) const {
    if (!is_exact) return;
    pairs.resize(KeepNear(rows(), rows(), margin, false, pairs));
  }

  // Makes room for ids below the limit. What has room does not throw.
  void Grow(std::size_t limit) {
    if (!is_exact || doubles.size() >= 2 * dims * limit) return;
    doubles.resize(2 * dims * limit);
  }
  // Stores the boxes of some objects, or without ids of all.
  void Store(const std::uint32_t* ids, const Columns& boxes) {
    if (is_exact) ReadRows(boxes, ids, doubles.data());
  }

  bool IsUsedBy(unsigned long thread) const {
    return std::find(users.begin(), users.end(), thread) != users.end();
  }
  // Whether a call of the thread waits. One that is inside of another, in a
  // function of the caller's, does not: the owner waits for the other.
  bool IsClosedTo(unsigned long thread) const {
    return owner != 0 && owner != thread && !IsUsedBy(thread);
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

// For both at the same time, so that a thread that owns neither keeps nobody
// waiting.
void WaitUntilOpen(Tree& tree, Tree& other) {
  if (tree.owner == 0 && other.owner == 0) return;
  const unsigned long self = PyThread_get_thread_ident();
  const auto is_open = [&] {
    return !tree.IsClosedTo(self) && !other.IsClosedTo(self);
  };
  if (is_open()) return;
  struct Waiting {
    explicit Waiting(Tree& its_tree) : tree(its_tree) { ++tree.waiting; }
    Waiting(const Waiting&) = delete;
    ~Waiting() {
      if (--tree.waiting == 0) TheWaiters().WakeAll();
    }
    Tree& tree;
  };
  const Waiting for_tree(tree);
  const Waiting for_other(other);
  TheWaiters().WaitUntil(is_open);
}
void WaitUntilOpen(Tree& tree) { WaitUntilOpen(tree, tree); }

// Exists while a call uses a tree. The constructor waits for the owner, and
// throws if another call changes the tree.
struct TreeReading {
  explicit TreeReading(Tree& its_tree, bool is_refit = false) : tree(its_tree) {
    WaitUntilOpen(tree);
    if (tree.is_changing) {
      throw std::runtime_error(
          "another call is changing this BVH: wait until it has finished");
    }
    if (tree.is_half_refitted && !is_refit) {
      throw std::runtime_error(
          "refit() of this BVH was interrupted: call refit() with all boxes "
          "again before any other call");
    }
    tree.users.push_back(thread);
  }
  TreeReading(const TreeReading&) = delete;
  ~TreeReading() {
    // Those of one thread are equal.
    *std::find(tree.users.begin(), tree.users.end(), thread) =
        tree.users.back();
    tree.users.pop_back();
    if (!tree.users.empty()) return;
    tree.is_changing = false;
    if (tree.owner_waits) TheWaiters().WakeAll();
  }

  Tree& tree;
  unsigned long thread = PyThread_get_thread_ident();
};
using Reading = TreeReading;

void Disown(Tree& tree) {
  if (tree.owner != PyThread_get_thread_ident() || --tree.owned != 0) return;
  tree.owner = 0;
  TheWaiters().WakeAll();
}

[[noreturn]] void ThrowInUse() {
  throw py::buffer_error(
      "the blob of this BVH is in use: release it before you change the BVH");
}

// Makes all other threads wait, and waits for the calls that run now.
void Own(Tree& tree) {
  const unsigned long self = PyThread_get_thread_ident();
  if (tree.IsUsedBy(self)) {
    if (tree.exports > 0) ThrowInUse();
    throw std::runtime_error(
        "changing() was called inside of a call of the same BVH");
  }
  // Lets the calls go first that have waited for an owner before: a thread that
  // owns a tree again and again would never give up the interpreter's lock in
  // between. Not for long, since such a call can wait for another tree that
  // this thread owns.
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::milliseconds(50);
  if (tree.owner == 0) {
    TheWaiters().WaitUntil(
        [&] { return tree.waiting == 0 || Clock::now() >= end; });
  }
  WaitUntilOpen(tree);
  tree.owner = self;
  ++tree.owned;
  tree.owner_waits = true;
  try {
    TheWaiters().WaitUntil([&] { return tree.users.empty(); });
    tree.owner_waits = false;
  } catch (...) {
    tree.owner_waits = false;
    Disown(tree);
    throw;
  }
}

// What `with tree.changing():` enters. In C++, because an exception of a signal
// can come between any two steps of a function in Python.
struct Changing {
  py::object owner;  // of the tree
  Tree* tree;
};

// Calls change() without the interpreter's lock. Waits for the owner. Throws if
// another call uses the tree, or if Python objects refer to its blob.
template <typename Function>
void Change(Tree& tree, const Function& change, bool is_refit = false) {
  WaitUntilOpen(tree);
  if (tree.exports > 0) ThrowInUse();
  if (!tree.users.empty()) {
    throw std::runtime_error(
        "another call is using this BVH: wait until it has finished before "
        "you change the BVH, or change it in `with tree.changing():`");
  }
  const Reading reading(tree, is_refit);
  tree.is_changing = true;
  if (is_refit) ++tree.changes;  // also if an exception ends it
  {
    const py::gil_scoped_release release;
    change();
  }
  if (!is_refit) ++tree.changes;
}

// With the interpreter's lock: a refit does not change sizes.
template <typename Value, hs_status (*kFunction)(const hs_bvh*, Value*)>
Value Ask(Tree& tree) {
  const Reading reading(tree, /*is_refit=*/std::is_integral_v<Value>);
  Value value{};
  Check(kFunction(tree.get(), &value));
  return value;
}

// How to build: the quality, and the extents of a typical query or none.
struct Build {
  bool is_fast = false;
  py::array_t<float, py::array::c_style> extents;

  explicit Build(const py::tuple& from)
      : is_fast(from[0].cast<bool>()),
        extents(from[1].cast<py::array_t<float, py::array::c_style>>()) {}

  hs_bvh_config Config(std::size_t dims) const;
};

hs_bvh_config ConfigOf(std::size_t dims, bool is_fast = false) {
  hs_bvh_config config = DefaultOf(&hs_bvh_config_default);
  config.kind = dims == 2 ? HS_BOX2 : HS_BOX3;
  config.quality = is_fast ? HS_QUALITY_FAST : HS_QUALITY_HIGH;
  return config;
}

hs_bvh_config Build::Config(std::size_t dims) const {
  hs_bvh_config config = ConfigOf(dims, is_fast);
  if (extents.size() != 0) config.query_extents = extents.data();
  return config;
}

Bvh BvhOf(const hs_columns& boxes, const hs_bvh_config& how, Work& work,
          std::size_t progress_end) {
  const bool is_double = boxes.type == HS_FLOAT64;
  // Doubles are rounded, then centers, six splits, a sort and a copy; or
  // centers and a copy.
  const bool is_fast = how.quality == HS_QUALITY_FAST;
  Threads threads{work, (is_double ? 1u : 0u) + (is_fast ? 2u : 9u),
                  progress_end, boxes.count};
  hs_bvh_config config = how;
  config.run = &Threads::Run;
  config.run_context = &threads;
  hs_bvh* bvh = nullptr;
  threads.Check(hs_bvh_create(&config, &boxes, &bvh));
  return Bvh(bvh);
}

std::unique_ptr<Tree> MakeTree(const py::tuple& arrays, const py::tuple& how,
                               bool is_exact, std::size_t threads,
                               py::object progress) {
  const Columns boxes(arrays);
  const Build build(how);
  Work work(threads, std::move(progress));
  auto tree = std::make_unique<Tree>();
  tree->dims = boxes.size / 2;
  const py::gil_scoped_release release;
  tree->bvh = BvhOf(boxes, build.Config(tree->dims), work, boxes.count);
  tree->is_exact = is_exact;
  tree->Grow(boxes.count);
  tree->Store(nullptr, boxes);
  // A BVH that never had an object has an empty blob, from which nobody could
  // tell its dimensions. One with room has a header.
  if (boxes.count == 0) Check(hs_bvh_reserve(tree->bvh.get(), 1));
  work.SetStage(0, 0, boxes.count);
  work.Finish();
  return tree;
}

// A path as a string of C.
const char* PathOf(const std::string& path) {
  if (path.find('\0') != std::string::npos) {
    throw std::invalid_argument("path: embedded null byte");
  }
  return path.c_str();
}

// Calls a function of C that reads or writes files. The error is the subclass
// of OSError that belongs to errno.
template <typename Call>
void CallFile(const Call& call) {
  hs_status status = HS_OK;
  int error = 0;
  {
    const py::gil_scoped_release release;
    errno = 0;
    status = call();
#if !defined(_WIN32)
    error = errno;
#endif
  }
  if (status == HS_IO_ERROR) {
    const py::str reason(hs_last_error_reason());
    py::object arguments = reason;
    if (error != 0) arguments = py::make_tuple(error, reason);
    PyErr_SetObject(PyExc_OSError, arguments.ptr());
    throw py::error_already_set();
  }
  Check(status);
}

void Save(Tree& tree, const std::string& path) {
  const Reading reading(tree);
  CallFile([&] { return hs_bvh_save(tree.get(), PathOf(path)); });
}

// Writes a tree of chunks of boxes to a file. Calls must come one after
// another.
class FileBuilder {
 public:
  FileBuilder(const std::string& path, std::size_t dims, const py::tuple& how,
              std::size_t memory) {
    const Build build(how);
    const hs_bvh_config config = build.Config(dims);
    hs_builder* builder = nullptr;
    CallFile([&] {
      return hs_builder_create_file(&config, PathOf(path), memory, &builder);
    });
    builder_.reset(builder);
  }

  void Push(const py::tuple& arrays) {
    const Columns boxes(arrays);
    CallFile([&] { return hs_builder_push(builder_.get(), &boxes); });
  }
  void Finish() {
    hs_bvh* bvh = nullptr;
    CallFile([&] { return hs_builder_finish(builder_.get(), &bvh); });
    hs_bvh_destroy(bvh);
  }

 private:
  std::unique_ptr<hs_builder, Destroy<&hs_builder_destroy>> builder_;
};

// In place if the bytes are aligned, and else a copy. `blob` is an array of
// bytes. An exact tree has its doubles next to them.
std::unique_ptr<Tree> FromBlob(
    const py::array_t<std::uint8_t>& blob, bool verify, bool is_exact,
    const py::array_t<double, py::array::c_style>& doubles) {
  constexpr std::size_t kAlignment = 64;
  const std::uint8_t* const bytes = blob.data();
  const auto size = Length(blob);
  if (size == 0) throw std::invalid_argument("the blob is empty");
  auto tree = std::make_unique<Tree>();
  if (reinterpret_cast<std::uintptr_t>(bytes) % kAlignment == 0) {
    tree->blob = blob;
  }
  tree->is_exact = is_exact;
  tree->doubles.assign(doubles.data(), doubles.data() + doubles.size());
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
  std::size_t limit = 0;
  Check(hs_bvh_id_limit(bvh, &limit));
  const std::size_t values = 2 * tree->dims;
  if (is_exact && (tree->doubles.size() % values != 0 ||
                   tree->doubles.size() / values < limit)) {
    throw std::invalid_argument("expected a box of float64 for each id");
  }
  return tree;
}

// What an array of a tree's bytes keeps alive. That of a pickle is a call of
// the thread that made it, for which changing() waits: the pickler reads the
// bytes after the call that returned them.
struct Export {
  explicit Export(const py::object& its_owner)
      : owner(its_owner), tree(its_owner.cast<Tree&>()), reading(tree) {
    ++tree.exports;
  }
  Export(const Export&) = delete;
  ~Export() { --tree.exports; }

  py::object owner;
  Tree& tree;
  std::optional<Reading> reading;
};

// The bytes of a tree as an array. A tree with such an array refuses changes.
py::array BlobOf(const py::object& object, bool is_pickle) {
  auto its = std::make_unique<Export>(object);
  Tree& tree = its->tree;
  const void* data = nullptr;
  std::size_t size = 0;
  {
    const py::gil_scoped_release release;
    Check(hs_bvh_blob(tree.get(), &data, &size));
  }
  if (!is_pickle) its->reading.reset();
  const py::capsule owner(its.get(), [](void* of) {
    const std::unique_ptr<Export> no_longer(static_cast<Export*>(of));
  });
  its.release();  // the capsule has it
  py::array_t<std::uint8_t> bytes(
      Size(size), static_cast<const std::uint8_t*>(data), owner);
  bytes.attr("setflags")(false);  // not to be written
  return bytes;
}

// Finds the pairs of a tree, and of `b` or of itself if this is null, by part.
// Removes those that the boxes by id reject, if there are any for both. Call it
// without the interpreter's lock.
Results<hs_id_pair> FindPairs(const hs_bvh* a, const hs_bvh* b,
                              hs_pair_options options, Work& work,
                              const Rows& of_a, const Rows& of_b) {
  std::size_t leaves = 0;
  Check(hs_bvh_pair_parts(a, &leaves));
  const std::size_t parts = PartsOf(leaves, kPartLeaves);
  Results<hs_id_pair> results(parts, work.threads(), 4096);
  work.Run(parts, [&](std::size_t part, std::size_t thread) {
    hs_pair_options its = options;
    its.begin = part * kPartLeaves;
    its.end = its.begin + kPartLeaves;
    results.Add(part, thread, [&](std::span<hs_id_pair> pairs) {
      std::size_t total = 0;
      Check(b == nullptr
                ? hs_bvh_pairs(a, &its, pairs.data(), pairs.size(), &total)
                : hs_bvh_join(a, b, &its, pairs.data(), pairs.size(), &total));
      const bool is_exact = !of_a.values.empty() && !of_b.values.empty();
      if (total > pairs.size() || !is_exact) return total;
      return KeepNear(of_a, of_b, std::max(options.margin, options.within),
                      options.within > 0, pairs.first(total));
    });
  });
  return results;
}

// Writes the row of each result. The results of row i end at ends[i].
void FillRows(const std::vector<std::size_t>& ends, std::int64_t* rows,
              Work& work) {
  constexpr std::size_t kInPart = 65536;
  work.Run(PartsOf(ends.size(), kInPart), [&](std::size_t part, std::size_t) {
    std::size_t i = part * kInPart;
    const std::size_t end = std::min(ends.size(), i + kInPart);
    for (std::size_t at = i == 0 ? 0 : ends[i - 1]; i < end; at = ends[i++]) {
      std::fill(rows + at, rows + ends[i], static_cast<std::int64_t>(i));
    }
  });
}

// Sorts the queries into trees of their own and joins the trees: queries that
// are near each other share what they read. Then sorts the pairs by row.
Ids QueryByJoin(Tree& tree, const py::tuple& arrays, const py::tuple& how) {
  const Columns boxes(arrays);
  hs_pair_options options = DefaultOf(&hs_pair_options_default);
  options.mask = MaskOf(how);
  Work work = WorkOf(how);
  Work building(work.threads(), py::none());
  const Reading reading(tree);
  std::vector<std::vector<hs_id_pair>> lists;
  std::vector<std::size_t> ends(boxes.count);
  {
    const py::gil_scoped_release release;
    std::size_t size = 0;
    Check(hs_bvh_size(tree.get(), &size));
    // A tree of 2^18 queries stays in the cache: 2 * 10^6 in one tree take up
    // to twice as long. In a large tree, queries share less the fewer they are.
    const std::size_t most = std::max(std::size_t{1} << 18, size);
    for (std::size_t first = 0; first < boxes.count; first += most) {
      Columns some = boxes;
      static_cast<hs_columns&>(some) = boxes.Rows(first, most);
      const Bvh queries =
          BvhOf(some, ConfigOf(tree.dims, /*is_fast=*/true), building,
                /*progress_end=*/0);
      std::vector<double> rows(tree.is_exact ? some.size * some.count : 0);
      if (tree.is_exact) ReadRows(some, nullptr, rows.data());
      const std::size_t end = first + some.count;
      work.SetStage(first, end, boxes.count);
      auto found = FindPairs(queries.get(), tree.get(), options, work,
                             {rows, tree.dims}, tree.rows());
      work.SetStage(end, end, boxes.count);
      // All pairs of a row are in one part.
      work.Run(found.lists.size(), [&](std::size_t part, std::size_t) {
        for (hs_id_pair& pair : found.lists[part]) {
          pair.a += static_cast<std::uint32_t>(first);
          ++ends[pair.a];
        }
      });
      std::move(found.lists.begin(), found.lists.end(),
                std::back_inserter(lists));
    }
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
  }
  const std::size_t found = ends.empty() ? 0 : ends.back();
  Ids ids(std::vector<std::size_t>{2, found});
  std::int64_t* const rows = ids.mutable_data();
  const py::gil_scoped_release release;
  work.SetLastStage();
  FillRows(ends, rows, work);
  work.Run(lists.size(), [&](std::size_t part, std::size_t) {
    for (const hs_id_pair& pair : lists[part]) {
      rows[found + --ends[pair.a]] = pair.b;
    }
  });
  work.Finish();
  return ids;
}

// Returns an array with the ids of one query, the first `skip` not and at most
// `limit`, and the number of all ids. Of these, some are removed if the tree is
// exact.
py::tuple QuerySome(Tree& tree, const py::tuple& arrays, std::uint32_t mask,
                    std::size_t skip, std::size_t limit) {
  const Columns boxes(arrays);
  hs_query_options options = Searches<Tree>::OptionsOf(mask);
  options.skip = skip;
  ShortIds ids(Size(limit));
  std::uint32_t* const to = ids.mutable_data();
  std::size_t total = 0;
  std::size_t count = 0;
  {
    const Reading reading(tree);
    const py::gil_scoped_release release;
    Check(
        hs_bvh_query(tree.get(), &boxes, &options, to, limit, nullptr, &total));
    count = std::min(limit, total - std::min(skip, total));
    if (tree.is_exact) count = tree.Keep(boxes, {to, count}, nullptr);
  }
  ids.resize({Size(count)});
  return py::make_tuple(ids, total);
}

// The boxes of a tree of floats as doubles, in the order of Tree::doubles.
std::vector<double> DoublesOf(const Tree& tree) {
  std::size_t count = 0;
  Check(hs_bvh_id_limit(tree.get(), &count));
  std::vector<float> floats(2 * tree.dims * count);
  Check(hs_bvh_get_all(tree.get(), floats.data(), count));
  return {floats.begin(), floats.end()};
}

// The pairs of a tree and of `b`, or of itself if this is null, in an array of
// shape (2, n). Those of one tree have i < j. If `is_round`, the margin is a
// Euclidean distance.
Ids PairsOf(Tree& tree, Tree* b, float margin, bool is_round,
            const py::tuple& how) {
  hs_pair_options options = DefaultOf(&hs_pair_options_default);
  (is_round ? options.within : options.margin) = margin;
  options.mask = MaskOf(how);
  Work work = WorkOf(how);
  const auto results = [&] {
    Tree& other = b == nullptr ? tree : *b;
    WaitUntilOpen(tree, other);
    const Reading reading(tree);
    const Reading reading_b(other);
    const py::gil_scoped_release release;
    // If one tree is exact, doubles decide. A tree of floats has none.
    Rows of_a = tree.rows();
    Rows of_b = other.rows();
    std::array<std::vector<double>, 2> made;
    if (tree.is_exact || other.is_exact) {
      if (!tree.is_exact) of_a.values = made[0] = DoublesOf(tree);
      if (&tree == &other) {
        of_b = of_a;
      } else if (!other.is_exact) {
        of_b.values = made[1] = DoublesOf(other);
      }
    }
    std::size_t size = 0;
    Check(hs_bvh_size(tree.get(), &size));
    work.SetStage(0, size, size);
    return FindPairs(tree.get(), b == nullptr ? nullptr : b->get(), options,
                     work, of_a, of_b);
  }();
  std::vector<std::size_t> offsets{0};
  for (const auto& list : results.lists) {
    offsets.push_back(offsets.back() + list.size());
  }
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
  Change(tree, [&] {
    std::size_t limit = 0;
    Check(hs_bvh_id_limit(tree.get(), &limit));
    tree.Grow(limit + boxes.count);
    Check(hs_bvh_insert(tree.get(), &boxes, to));
    tree.Store(to, boxes);
  });
  return ids;
}

void Erase(Tree& tree, const ShortIds& ids) {
  Change(tree,
         [&] { Check(hs_bvh_erase(tree.get(), ids.data(), Length(ids))); });
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
        hs_bvh_refit(tree.get(), &boxes, &Threads::Run, &its_threads));
    tree.Grow(boxes.count);
    tree.Store(nullptr, boxes);
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
  const std::uint32_t* const first = ids.data();
  Change(tree, [&] {
    if (boxes.count > 0 && kFunction == &hs_bvh_insert_as) {
      tree.Grow(std::size_t{*std::max_element(first, first + boxes.count)} + 1);
    }
    Check(kFunction(tree.get(), first, &boxes));
    tree.Store(first, boxes);
  });
}

// Of some objects, or of all if there are no ids.
void SetMasks(Tree& tree, const ShortIds& ids, const ShortIds& masks) {
  const auto count = Length(masks);
  if (ids.size() != 0 && ids.size() != masks.size()) ThrowNotPrepared();
  Change(tree, [&] {
    Check(ids.size() != 0
              ? hs_bvh_set_masks(tree.get(), ids.data(), masks.data(), count)
              : hs_bvh_set_all_masks(tree.get(), masks.data(), count));
  });
}

void Rebuild(Tree& tree, const py::tuple& how, std::size_t threads) {
  const Build build(how);
  Work work(threads, py::none());
  Threads its_threads{work, 9, 0, 0};
  hs_bvh_config config = build.Config(tree.dims);
  config.run = &Threads::Run;
  config.run_context = &its_threads;
  Change(tree, [&] {
    its_threads.Check(hs_bvh_rebuild(tree.get(), &config));
    std::size_t size = 0;
    Check(hs_bvh_size(tree.get(), &size));
    // As in MakeTree().
    if (size == 0) Check(hs_bvh_reserve(tree.get(), 1));
  });
}

double ExpectedLeaves(Tree& tree,
                      const py::array_t<float, py::array::c_style>& extents) {
  const Reading reading(tree);
  double leaves = 0;
  Check(hs_bvh_expected_leaves(tree.get(), extents.data(), &leaves));
  return leaves;
}

py::array_t<double> Doubles(Tree& tree) {
  const Reading reading(tree);
  return py::array_t<double>(Size(tree.doubles.size()), tree.doubles.data());
}

py::array_t<float> BoundsOf(Tree& tree) {
  const Reading reading(tree);
  py::array_t<float> values(Size(2 * tree.dims));
  Check(hs_bvh_bounds(tree.get(), values.mutable_data()));
  return values;
}

// The boxes by id, one after another; that of no object is empty.
py::array_t<float> Boxes(Tree& tree) {
  const Reading reading(tree);
  std::size_t count = 0;
  Check(hs_bvh_id_limit(tree.get(), &count));
  py::array_t<float> values(std::vector<std::size_t>{count, 2 * tree.dims});
  float* const to = values.mutable_data();
  const py::gil_scoped_release release;
  Check(hs_bvh_get_all(tree.get(), to, count));
  return values;
}

}  // namespace

std::vector<std::uint32_t> OrderByPlace(const Columns& records,
                                        std::size_t dims, Work& work) {
  std::vector<std::uint32_t> order(records.count);
  // In parts, because a tree of doubles takes 60 bytes a record.
  constexpr std::size_t kMost = std::size_t{1} << 20;
  for (std::size_t first = 0; first < records.count; first += kMost) {
    hs_columns points = records.Rows(first, kMost);
    for (std::size_t k = 0; k < dims; ++k) {
      points.column[dims + k] = points.column[k];
    }
    const Bvh bvh = BvhOf(points, ConfigOf(dims, /*is_fast=*/true), work,
                          /*progress_end=*/0);
    std::array<float, 6> everything;
    Check(hs_bvh_bounds(bvh.get(), everything.data()));
    // Rays from one camera start at one place: no order helps. Doubles at one
    // place are rounded to two floats.
    bool are_apart = false;
    for (std::size_t k = 0; k < dims; ++k) {
      const float min = everything[k];
      are_apart |= everything[dims + k] >
                   std::nextafter(min, std::numeric_limits<float>::infinity());
    }
    if (!are_apart) return {};
    const hs_columns query = hs_float_rows(everything.data(), 1, 2 * dims);
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(first);
    std::size_t total = 0;
    Check(hs_bvh_query(bvh.get(), &query, nullptr, &*begin, points.count,
                       nullptr, &total));
    if (total != points.count) return {};
    const auto end = begin + static_cast<std::ptrdiff_t>(total);
    std::transform(begin, end, begin, [first](std::uint32_t i) {
      return static_cast<std::uint32_t>(first + i);
    });
  }
  return order;
}

const hs_bvh* HandleOf(const py::object& tree) {
  return tree.cast<const Tree&>().get();
}

void DefineTree(py::module_& module) {
  py::class_<Tree> of(module, "Tree");
  Searches<Tree>::Define(of);
  of.def(py::init(&MakeTree))
      .def_static("from_blob", &FromBlob)
      .def("query_by_join", &QueryByJoin)
      .def("query_some", &QuerySome)
      .def("blob", &BlobOf)
      .def("save", &Save)
      .def("pairs", &PairsOf)
      .def("insert", &Insert)
      .def("insert_as", &SetSome<&hs_bvh_insert_as>)
      .def("erase", &Erase)
      .def("refit", &Refit)
      .def("refit_some", &SetSome<&hs_bvh_set>)
      .def("set_masks", &SetMasks)
      .def("rebuild", &Rebuild)
      .def("cost_ratio", &Ask<double, &hs_bvh_cost_ratio>)
      .def("expected_leaves", &ExpectedLeaves)
      .def("changing",
           [](const py::object& self) {
             return Changing{self, self.cast<Tree*>()};
           })
      .def("bounds", &BoundsOf)
      .def("boxes", &Boxes)
      .def("doubles", &Doubles)
      .def("size", &Ask<std::size_t, &hs_bvh_size>)
      .def("id_limit", &Ask<std::size_t, &hs_bvh_id_limit>)
      .def("nbytes",
           [](Tree& tree) {
             return Ask<std::size_t, &hs_bvh_bytes>(tree) +
                    tree.doubles.capacity() * sizeof(double);
           })
      .def_readonly("changes", &Tree::changes);
  py::class_<FileBuilder>(module, "FileBuilder")
      .def(py::init<const std::string&, std::size_t, const py::tuple&,
                    std::size_t>())
      .def("push", &FileBuilder::Push)
      .def("finish", &FileBuilder::Finish);
  py::class_<Changing>(module, "Changing")
      .def("__enter__", [](const Changing& its) { Own(*its.tree); })
      .def("__exit__", [](const Changing& its, const py::args& /*unused*/) {
        Disown(*its.tree);
      });
}

}  // namespace halfspace::python
