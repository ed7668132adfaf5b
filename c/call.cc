#include "c/call.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "halfspace/version.h"

namespace halfspace::c {
namespace {

// The message of the last error of this thread. Nothing is allocated for it:
// there may be no memory.
struct Message {
  char text[512];
  char argument[sizeof(Name)];
  std::size_t reason;  // where it begins in the text
};
constinit thread_local Message last_error{};

// More than a struct will ever have: so a size that was never set is found, and
// no memory far behind the struct is read.
constexpr std::size_t kLargestStruct = 4096;

[[gnu::format(HALFSPACE_PRINTF, 3, 0)]] void SetMessageV(
    const Call& call, const Name& argument, const char* format,
    std::va_list arguments) {
  // Into another buffer, because an argument can be part of the last message.
  Message message;
  std::strcpy(message.argument, argument.c_str());
  const int length =
      std::snprintf(message.text, sizeof(message.text), "%s: %s%s", call.name(),
                    message.argument, message.argument[0] != '\0' ? ": " : "");
  message.reason = static_cast<std::size_t>(std::max(length, 0));
  std::vsnprintf(message.text + message.reason,
                 sizeof(message.text) - message.reason, format, arguments);
  last_error = message;
}

[[gnu::format(HALFSPACE_PRINTF, 3, 4)]] void SetMessage(const Call& call,
                                                        const Name& argument,
                                                        const char* format,
                                                        ...) {
  std::va_list arguments;
  va_start(arguments, format);
  SetMessageV(call, argument, format, arguments);
  va_end(arguments);
}

// The arguments of C++ functions that have another name here. An empty call is
// any call that is not listed with the argument.
struct NameInC {
  std::string_view call;
  std::string_view argument;
  std::string_view in_c;
};
constexpr NameInC kNames[] = {
    {"", "blob", "bvh"},
    {"", "id", "ids"},
    {"", "world", "objects"},
    {"", "world.size", "scan"},
    {"Bvh::Refit", "bounds", "objects"},
    {"", "options.margin", "options->margin"},
    {"", "options.within", "options->within"},
    {"MemoryResource::allocate", "the result", "allocator.allocate"},
};

std::string_view NameOf(const Error& error) {
  std::string_view found = error.argument();
  for (const NameInC& name : kNames) {
    if (name.argument != error.argument()) continue;
    if (name.call == error.call()) return name.in_c;
    if (name.call.empty()) found = name.in_c;
  }
  return found;
}

void SetMessage(const Call& call, const Error& error,
                std::string_view argument) {
  const std::string_view expected = error.expected();
  SetMessage(call, Name(argument, error.index()), "expected %.*s, got %s",
             static_cast<int>(expected.size()), expected.data(),
             error.given().data());
}

}  // namespace

Name::Name(std::string_view argument, std::size_t index) {
  char in_brackets[24] = "";
  if (index != Error::kNoIndex) {
    std::snprintf(in_brackets, sizeof(in_brackets), "[%zu]", index);
  }
  std::snprintf(text_.data(), text_.size(), "%.*s%s",
                static_cast<int>(argument.size()), argument.data(),
                in_brackets);
}

Name::Name(const char* argument, const char* field, std::size_t index) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%s%s", argument, field);
  *this = Name(std::string_view(text.data()), index);
}

void Call::Fail(hs_status status, const Name& argument, const char* format,
                ...) const {
  std::va_list arguments;
  va_start(arguments, format);
  SetMessageV(*this, argument, format, arguments);
  va_end(arguments);
  throw Failure{status};
}

void Call::Fail(hs_status status, const Error& error,
                const char* argument) const {
  SetMessage(*this, error, argument);
  throw Failure{status};
}

void Call::FailNull(const char* argument) const {
  Fail(HS_INVALID_ARGUMENT, argument, "expected a pointer, got null");
}

void Call::FailMisaligned(const char* argument, std::size_t alignment) const {
  Fail(HS_INVALID_ARGUMENT, argument,
       "expected memory aligned to %zu bytes, got a misaligned pointer",
       alignment);
}

void Call::FailTooMany(const char* argument, std::size_t count) const {
  Fail(HS_INVALID_ARGUMENT, argument,
       "expected a size that fits the address space, got %zu elements", count);
}

hs_status StatusOfException(const Call& call) noexcept {
  try {
    throw;
  } catch (const Failure& failure) {
    return failure.status;
  } catch (const std::bad_alloc&) {
    SetMessage(call, "", "an allocation failed");
    return HS_OUT_OF_MEMORY;
  } catch (const std::length_error&) {
    SetMessage(call, "", "expected sizes that fit the address space, got more");
    return HS_OUT_OF_MEMORY;
  } catch (const Error& error) {
    SetMessage(call, error, NameOf(error));
    return HS_INVALID_ARGUMENT;
  } catch (const std::exception& error) {
    SetMessage(call, "", "an exception ended the call: %s", error.what());
    return HS_INTERNAL;
  } catch (...) {
    SetMessage(call, "",
               "an exception of a callback, an allocator or an error handler "
               "ended the call");
    return HS_INTERNAL;
  }
}

void ReadStruct(const Call& call, const char* argument, const void* given,
                void* options, std::size_t size) {
  std::size_t given_size = 0;
  std::memcpy(&given_size, given, sizeof(given_size));
  if (given_size < sizeof(given_size) || given_size > kLargestStruct) {
    call.Fail(HS_INVALID_ARGUMENT, {argument, "->struct_size"},
              "expected sizeof *%s, as the function "
              "..._default() sets it, got %zu",
              argument, given_size);
  }
  if (given_size % 4 != 0) {
    call.Fail(HS_INVALID_ARGUMENT, {argument, "->struct_size"},
              "expected a multiple of 4, as the function "
              "..._default() sets it, got %zu",
              given_size);
  }
  const auto* const bytes = static_cast<const unsigned char*>(given);
  for (std::size_t i = size; i < given_size; ++i) {
    if (bytes[i] == 0) continue;
    call.Fail(HS_INVALID_ARGUMENT, argument,
              "expected a struct of up to %zu bytes, or 0 in the others, "
              "as this library knows no more fields, got another value at byte "
              "%zu: use a newer library",
              size, i);
  }
  std::memcpy(options, given, std::min(size, given_size));
}

hs_status WriteDefaults(const char* name, const void* defaults,
                        std::size_t size, void* options,
                        std::size_t struct_size) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer("the struct", static_cast<std::size_t*>(options));
    if (struct_size < sizeof(std::size_t) || struct_size > kLargestStruct ||
        struct_size % 4 != 0) {
      call.Fail(HS_INVALID_ARGUMENT, "struct_size",
                "expected the sizeof of the struct, got %zu", struct_size);
    }
    std::memset(options, 0, struct_size);
    std::memcpy(options, defaults, std::min(size, struct_size));
    std::memcpy(options, &struct_size, sizeof(struct_size));
  });
}

Target ReadTarget(const Call& call, const char* argument, const char* name) {
  if (name == nullptr) return {};
  const std::optional<Target> target = FindTarget(name);
  if (!target) {
    call.Fail(HS_INVALID_ARGUMENT,
              argument == nullptr ? Name("target") : Name(argument, "->target"),
              "expected null or a name of hs_target_name(), got "
              "\"%.64s\"",
              name);
  }
  return *target;
}

MemoryResource ReadAllocator(const Call& call, const hs_allocator& allocator,
                             const char* argument) {
  if ((allocator.allocate == nullptr) != (allocator.deallocate == nullptr)) {
    call.Fail(HS_INVALID_ARGUMENT, argument,
              "expected both functions or neither, got %s "
              "alone",
              allocator.allocate != nullptr ? "allocate" : "deallocate");
  }
  return {allocator.allocate, allocator.deallocate, allocator.context};
}

}  // namespace halfspace::c

using halfspace::c::Call;

const char* hs_version() { return HALFSPACE_VERSION_STRING; }

const char* hs_last_error() { return halfspace::c::last_error.text; }

const char* hs_last_error_argument() {
  return halfspace::c::last_error.argument;
}

const char* hs_last_error_reason() {
  const auto& message = halfspace::c::last_error;
  return message.text + message.reason;
}

const char* hs_status_name(hs_status status) {
  switch (status) {
    case HS_OK:
      return "HS_OK";
    case HS_INVALID_ARGUMENT:
      return "HS_INVALID_ARGUMENT";
    case HS_OUT_OF_MEMORY:
      return "HS_OUT_OF_MEMORY";
    case HS_IO_ERROR:
      return "HS_IO_ERROR";
    case HS_CORRUPT:
      return "HS_CORRUPT";
    case HS_UNSUPPORTED:
      return "HS_UNSUPPORTED";
    case HS_INTERNAL:
      return "HS_INTERNAL";
  }
  return "unknown status";
}

size_t hs_target_count() { return halfspace::SupportedTargets().size(); }

const char* hs_target_name(size_t i) {
  const auto targets = halfspace::SupportedTargets();
  // Names are literals of Highway, so they end with a null character.
  return i < targets.size() ? targets[i].name().data() : nullptr;
}

hs_status hs_chosen_target(const char** name) {
  return halfspace::c::Run("hs_chosen_target", [&](const Call& call) {
    call.CheckPointer("name", name);
    *name = halfspace::ChosenTarget().name().data();
  });
}
