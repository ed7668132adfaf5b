// How much stack a call takes.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_STACK_USE_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_STACK_USE_H_

#include <gtest/gtest.h>
#include <pthread.h>

#include <array>
#include <cstddef>

namespace halfspace::testing {

// Twice as much as a thread must have on ARM.
alignas(4096) inline std::array<std::byte, 256 * 1024> painted_stack;

// From a thread's frame to the lowest byte of its stack that call() changes.
template <typename Call>
std::size_t StackUse(const Call& call) {
  constexpr std::byte kPaint{0xa5};
  struct Job {
    const Call& call;
    std::size_t used;
  } job = {call, 0};
  call();  // what is done once, such as to bind symbols, is not counted
  painted_stack.fill(kPaint);
  const auto run = [](void* argument) -> void* {
    Job& its = *static_cast<Job*>(argument);
    const auto* frame = static_cast<std::byte*>(__builtin_frame_address(0));
    its.call();
    const std::byte* lowest = painted_stack.data();
    while (*lowest == kPaint) ++lowest;
    its.used = static_cast<std::size_t>(frame - lowest);
    return nullptr;
  };
  pthread_attr_t attributes;
  pthread_t thread;
  pthread_attr_init(&attributes);
  EXPECT_EQ(pthread_attr_setstack(&attributes, painted_stack.data(),
                                  painted_stack.size()),
            0);
  const int error = pthread_create(&thread, &attributes, run, &job);
  EXPECT_EQ(error, 0);
  if (error == 0) pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  return job.used;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_STACK_USE_H_
