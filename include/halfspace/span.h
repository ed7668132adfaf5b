// Span: the type of all array parameters, a pointer and a size.
//
// Span is C++20's std::span with a dynamic extent, also for C++17. A call is
// the same function in C++17 and in C++20.
//
// Arrays convert to a Span implicitly: C arrays, std::array, std::vector,
// std::span, another Span, and any class whose data() and size() describe an
// array. A pointer and a count also convert: {pointer, count}.
//   Span<const T>  input; also converts from const arrays and from temporaries
//   Span<T>        output; converts only from arrays that are not const
// A Span converts to a std::span implicitly. A temporary Span converts only to
// a std::span of const elements, and it is no borrowed range: store it before
// std::ranges::find and others return an iterator into it.
//
// A Span owns nothing: the elements must outlive it. operator[] does not check
// its index.
//
// Thread safety: a plain value.
#ifndef HALFSPACE_SPAN_H_
#define HALFSPACE_SPAN_H_

#include <array>  // std::data and std::size; <iterator> is twice as long
#include <cstddef>
#include <type_traits>
#include <utility>

#include "halfspace/detail/cxx17.h"  // IWYU pragma: keep

namespace halfspace {

namespace detail {

// A type only if std::data(list) points to T, or to T without const. A class
// derived from T does not match, because it can have another size.
template <typename T, typename List>
using IfListOf = std::enable_if_t<
    std::is_convertible_v<
        std::remove_pointer_t<decltype(std::data(std::declval<List&>()))> (*)[],
        T (*)[]>,
    decltype(std::size(std::declval<List&>()))>;

}  // namespace detail

template <typename T>
class Span {
 public:
  using element_type = T;
  using value_type = std::remove_cv_t<T>;

  constexpr Span() noexcept = default;
  constexpr Span(T* data, std::size_t size) noexcept
      : data_(data), size_(size) {}
  // Without this, {0, 1}, meant as two numbers, would be a null pointer and a
  // size. A null pointer is nullptr.
  Span(int, std::size_t) = delete;

  // A const list or a temporary binds to the second constructor. Its
  // std::data() is a pointer to const, unless it does not own its elements.
  template <typename List, typename = detail::IfListOf<T, List>>
  // NOLINTNEXTLINE(google-explicit-constructor): lists convert implicitly.
  constexpr Span(List& list) noexcept
      : data_(std::data(list)),
        size_(static_cast<std::size_t>(std::size(list))) {}
  template <typename List, typename = detail::IfListOf<T, const List>>
  // NOLINTNEXTLINE(google-explicit-constructor): as above.
  constexpr Span(const List& list) noexcept
      : data_(std::data(list)),
        size_(static_cast<std::size_t>(std::size(list))) {}

  constexpr T* data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr T* begin() const noexcept { return data_; }
  constexpr T* end() const noexcept { return data_ + size_; }
  constexpr T& operator[](std::size_t i) const { return data_[i]; }
  constexpr T& front() const { return data_[0]; }
  constexpr T& back() const { return data_[size_ - 1]; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace halfspace

#endif  // HALFSPACE_SPAN_H_
