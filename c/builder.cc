// hs_builder_...(): objects in batches, in memory or in a file.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <list>
#include <new>
#include <optional>
#include <string>

#include "c/bvh.h"
#include "c/call.h"
#include "c/columns.h"
#include "c/files.h"

using halfspace::Span;
using halfspace::c::BvhConfig;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::NewFile;
using halfspace::c::NoCancel;
using halfspace::c::Run;
using halfspace::c::Values;

struct hs_builder {
  explicit hs_builder(const BvhConfig& its_config)
      : config(its_config),
        objects(Values::OfObjects(its_config.layout)),
        rows(halfspace::detail::BlockAllocator<float>(
            its_config.options.memory)) {}
  hs_builder(const BvhConfig& its_config, const Call& call, const char* path)
      : hs_builder(its_config) {
    file.emplace(call, path, NewFile::kTemporary);
  }

  const BvhConfig config;
  const Values objects;
  std::size_t count = 0;
  halfspace::c::FloatVector rows;
  std::optional<NewFile> file;  // has the rows if there is one
};

namespace halfspace::c {
namespace {

constexpr std::size_t kDefaultMemory = std::size_t{1} << 28;

// Blocks for which `limit` bytes of memory have no room are new files next to a
// path.
class FileMemory {
 public:
  FileMemory(const Call& call, const char* path, const MemoryResource& memory,
             std::size_t limit)
      : call_(call), path_(path), memory_(memory), left_(limit) {}

  MemoryResource resource() { return {&Allocate, &Deallocate, this}; }

  // Replaces the path by the file of a block, if it has one. The block cannot
  // be read afterwards.
  bool Publish(const void* block) {
    const auto file = Find(block);
    if (file == files_.end()) return false;
    file->Publish(call_);
    return true;
  }

 private:
  std::list<NewFile>::iterator Find(const void* block) {
    return std::find_if(
        files_.begin(), files_.end(),
        [block](const NewFile& file) { return file.mapped() == block; });
  }
  static void* Allocate(void* context, std::size_t bytes, std::size_t) {
    auto& own = *static_cast<FileMemory*>(context);
    if (bytes <= own.left_) {
      void* const block = detail::AllocateBlock(own.memory_, bytes);
      own.left_ -= bytes;
      return block;
    }
    own.files_.emplace_back(own.call_, own.path_, NewFile::kToPublish);
    try {
      return own.files_.back().Map(own.call_, bytes);
    } catch (...) {
      own.files_.pop_back();
      throw;
    }
  }
  static void Deallocate(void* context, void* block, std::size_t bytes,
                         std::size_t) {
    auto& own = *static_cast<FileMemory*>(context);
    if (const auto file = own.Find(block); file != own.files_.end()) {
      own.files_.erase(file);
    } else {
      detail::FreeBlock(own.memory_, block, bytes);
      own.left_ += bytes;
    }
  }

  Call call_;
  const char* path_;
  MemoryResource memory_;
  std::size_t left_;
  std::list<NewFile> files_;
};

// Appends all rows or none.
void PushToFile(const Call& call, const hs_columns& objects,
                hs_builder& builder) {
  NewFile& file = *builder.file;
  const std::fpos_t end = file.Position(call);
  try {
    ForEachRows(objects, builder.objects,
                [&](const float* rows, std::size_t, std::size_t count) {
                  file.Write(call,
                             {reinterpret_cast<const std::byte*>(rows),
                              count * builder.objects.count * sizeof(float)});
                });
    file.Flush(call);
  } catch (...) {
    file.Return(end);
    throw;
  }
}

// Writes the tree to its file, and maps it.
NewBvh BuildFile(const Call& call, const hs_builder& builder) {
  const std::string absolute = builder.file->AbsolutePath();
  const char* const path = absolute.c_str();
  const std::uint64_t bytes =
      std::uint64_t{builder.count} * builder.objects.count * sizeof(float);
  if (bytes > PTRDIFF_MAX) throw std::bad_alloc();
  {
    const Mapped rows{bytes == 0 ? Span<const std::byte>()
                                 : builder.file->MapWritten(
                                       call, static_cast<std::size_t>(bytes))};
    BvhConfig config = builder.config;
    FileMemory memory(call, path, config.options.memory,
                      config.options.run_bytes);
    config.options.memory = memory.resource();
    const NewBvh bvh = BuildBvh(
        call, config,
        detail::ColumnsOfRows(reinterpret_cast<const float*>(rows.bytes.data()),
                              builder.count, builder.objects.count));
    if (!memory.Publish(bvh->core.Blob().data())) {
      SaveBvh(call, path, config.layout, bvh->core);
    }
  }
  return MapBvh(call, path, builder.config);
}

}  // namespace
}  // namespace halfspace::c

hs_status hs_builder_create(const hs_bvh_config* config, hs_builder** builder) {
  return Run("hs_builder_create", [&](const Call& call) {
    call.CheckPointer("builder", builder);
    const BvhConfig read(call, config);
    *builder = halfspace::c::New<hs_builder>(read.options.memory, read);
  });
}

hs_status hs_builder_create_file(const hs_bvh_config* config, const char* path,
                                 size_t memory, hs_builder** builder) {
  return Run("hs_builder_create_file", [&](const Call& call) {
    const NoCancel no_cancel;
    call.CheckPointer("builder", builder);
    call.CheckPointer("path", path);
    BvhConfig read(call, config);
    read.options.run_bytes =
        memory != 0 ? memory : halfspace::c::kDefaultMemory;
    *builder =
        halfspace::c::New<hs_builder>(read.options.memory, read, call, path);
  });
}

hs_status hs_builder_push(hs_builder* builder, const hs_columns* objects) {
  return Run("hs_builder_push", [&](const Call& call) {
    const NoCancel no_cancel;
    call.CheckPointer("builder", builder);
    CheckColumns(call, "objects", objects, builder->objects);
    const size_t values = builder->objects.count;
    const size_t count = builder->count + objects->count;
    halfspace::detail::BvhTree(halfspace::c::TypeOf(builder->config.layout),
                               builder->config.options.memory)
        .CheckBuild(count, builder->config.options);
    if (builder->file) {
      halfspace::c::PushToFile(call, *objects, *builder);
    } else {
      builder->rows.resize(count * values);
      halfspace::c::WriteRows(*objects, builder->objects, 0, objects->count,
                              builder->rows.data() + builder->count * values);
    }
    builder->count = count;
  });
}

hs_status hs_builder_finish(const hs_builder* builder, hs_bvh** bvh) {
  return Run("hs_builder_finish", [&](const Call& call) {
    const NoCancel no_cancel;
    call.CheckPointer("builder", builder);
    call.CheckPointer("bvh", bvh);
    if (builder->file) {
      *bvh = halfspace::c::BuildFile(call, *builder).release();
    } else {
      *bvh = halfspace::c::BuildBvh(call, builder->config,
                                    halfspace::detail::ColumnsOfRows(
                                        builder->rows.data(), builder->count,
                                        builder->objects.count))
                 .release();
    }
  });
}

void hs_builder_destroy(hs_builder* builder) {
  const NoCancel no_cancel;
  if (builder == nullptr) return;
  halfspace::c::Delete(builder->config.options.memory, builder);
}
