// The BVH of a Python object.
#ifndef HALFSPACE_PYTHON_TREE_H_
#define HALFSPACE_PYTHON_TREE_H_

#include <halfspace/c/halfspace.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <span>

namespace halfspace::python {

// A buffer of another Python object.
class Buffer {
 public:
  explicit Buffer(const pybind11::object& object);
  ~Buffer() { PyBuffer_Release(&view_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  std::span<const std::byte> bytes() const {
    return {static_cast<const std::byte*>(view_.buf),
            static_cast<std::size_t>(view_.len)};
  }

 private:
  Py_buffer view_;
};

struct DestroyBvh {
  void operator()(hs_bvh* bvh) const { hs_bvh_destroy(bvh); }
};
using Bvh = std::unique_ptr<hs_bvh, DestroyBvh>;

// Calls run without the interpreter's lock, so another thread can call the same
// object. Its counters are read and written with the lock.
struct Tree {
  std::unique_ptr<Buffer> buffer;  // of a blob in place
  Bvh bvh;
  std::size_t dims = 3;
  std::size_t readers = 0;  // calls that read now
  std::size_t exports = 0;  // blobs that Python objects refer to
  bool is_changing = false;
  bool is_half_refitted = false;  // an exception ended Refit()
  std::size_t changes = 0;        // so far
};

// Exists while a call reads a tree. The constructor throws if another call
// changes the tree.
class Reading {
 public:
  explicit Reading(Tree& tree, bool is_refit = false);
  ~Reading() { --tree_.readers; }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  Tree& tree_;
};

// Exists while a call changes a tree. The constructor throws if another call
// uses the tree, or if Python objects refer to its blob.
class Changing {
 public:
  explicit Changing(Tree& tree, bool is_refit = false);
  ~Changing() { tree_.is_changing = false; }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;

 private:
  Tree& tree_;
};

// Adds the class Tree and join() to the module.
void DefineTree(pybind11::module_& module);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_TREE_H_
