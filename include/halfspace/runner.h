// Runner: the caller's threads, for the builds and refits of bvh.h, and for the
// searches of pair_events.h.
//
//   auto run = [&](std::size_t count, const halfspace::Runner::Part& part) {
//     pool.ParallelFor(count, part);
//   };
//   halfspace::AabbBvh3 bvh(world, {.run = run});  // C++20
//   bvh.Refit(bounds, run);
//
// Thread safety: a plain value. The library calls `run` in the calling thread,
// several times during one call of bvh.h.
#ifndef HALFSPACE_RUNNER_H_
#define HALFSPACE_RUNNER_H_

#include <cstddef>
#include <type_traits>

#include "halfspace/detail/cxx17.h"  // IWYU pragma: keep

namespace halfspace {

namespace detail {

// The address of a function object, as std::addressof() in <memory>, which has
// 52 000 lines in C++20.
template <typename Function>
void* ContextOf(Function& function) {
  return &const_cast<char&>(reinterpret_cast<const volatile char&>(function));
}

}  // namespace detail

// Refers to a function object that is called as run(count, part). It must call
// part(i) once for each i below `count`, in any order and on any threads, and
// return when all these calls have returned.
//
// A Runner owns nothing. A function object that is passed to a call, directly
// or in a BuildOptions{...} there, lives long enough. If you store a Runner,
// keep the function object.
class Runner {
 public:
  // A part of the work, number i of `count`. Can be copied, and is valid until
  // the call of run() returns.
  class Part {
   public:
    void operator()(std::size_t i) const { call_(context_, i); }

   private:
    friend class Runner;

    template <typename Function>
    explicit Part(const Function& function)
        : call_([](const void* context, std::size_t i) {
            (*static_cast<const Function*>(context))(i);
          }),
          context_(detail::ContextOf(function)) {}

    void (*call_)(const void* context, std::size_t i);
    const void* context_;
  };

  // The calling thread calls the parts in turn.
  constexpr Runner() = default;

  template <typename Run,
            typename = std::enable_if_t<
                !std::is_same_v<std::decay_t<Run>, Runner> &&
                std::is_object_v<std::remove_reference_t<Run>> &&
                std::is_invocable_v<Run&, std::size_t, const Part&>>>
  // NOLINTNEXTLINE(google-explicit-constructor): functions convert implicitly.
  Runner(Run&& run) noexcept
      : run_([](const void* context, std::size_t count, const Part& part) {
          using Object = std::remove_reference_t<Run>;
          (*static_cast<Object*>(const_cast<void*>(context)))(count, part);
        }),
        context_(detail::ContextOf(run)) {}

  // Whether it refers to a function object.
  explicit operator bool() const { return run_ != nullptr; }

  // Calls part(i) for each i below `count`.
  template <typename Function>
  void operator()(std::size_t count, const Function& part) const {
    const Part each(part);
    if (run_ != nullptr) return run_(context_, count, each);
    for (std::size_t i = 0; i < count; ++i) each(i);
  }

 private:
  void (*run_)(const void* context, std::size_t count,
               const Part& part) = nullptr;
  const void* context_ = nullptr;
};

}  // namespace halfspace

#endif  // HALFSPACE_RUNNER_H_
