#include "viewer/gl/pixel_counter.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

#include "viewer/gl/shader_program.h"

namespace meshfront {
namespace {

// Three atomic additions a pixel. On llvmpipe, one addition a pixel on its triangle and a second
// pass over the triangles takes half the time at 70 thousand triangles, twice at two million, and a
// counter a triangle; merging runs of equal pixels first takes longer than it saves.
// One dispatch an instance, as each has its own corners.
constexpr char kCountShader[] = R"(#version 450 core
layout(local_size_x = 16, local_size_y = 16) in;
layout(binding = 0, r32ui) uniform readonly uimage2D items;
layout(std430, binding = 0) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 1) buffer Counts { uint counts[]; };
layout(location = 0) uniform uint firstItem;  // of this instance
layout(location = 1) uniform uint faces;
layout(location = 2) uniform uint firstCount;
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(items)))) {
    return;
  }
  uint face = imageLoad(items, at).r - firstItem;  // the background wraps around
  if (face >= faces) {
    return;
  }
  atomicAdd(counts[firstCount + corners[3u * face]], 1u);
  atomicAdd(counts[firstCount + corners[3u * face + 1u]], 1u);
  atomicAdd(counts[firstCount + corners[3u * face + 2u]], 1u);
}
)";
constexpr GLuint kGroupSide = 16;  // pixels, as in the shader

size_t vertexSlotsOf(std::span<const MeshInstance> instances) {
  size_t total = 0;
  for (const MeshInstance& instance : instances) total += instance.mesh->vertexCount();
  return total;
}

}  // namespace

PixelCounter::Method PixelCounter::preferred(const GlContext& context) {
  return context.isSoftware() ? Method::readBack : Method::compute;
}

PixelCounter PixelCounter::create(Method wanted) {
  PixelCounter counter(wanted);
  if (wanted == Method::compute) {
    auto program = computeProgram("pixel count", kCountShader);
    if (program) {
      counter.program_ = std::move(*program);
    } else {
      counter.method_ = Method::readBack;
      counter.fallbackReason_ = program.error().message;
    }
  }
  return counter;
}

bool PixelCounter::canCompute(std::span<const MeshInstance> instances) const {
  if (method_ != Method::compute) return false;
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  const size_t total = vertexSlotsOf(instances);
  return total > 0 && total * sizeof(uint32_t) <= static_cast<uint64_t>(limit) &&
         std::all_of(instances.begin(), instances.end(), [](const MeshInstance& instance) {
           return instance.mesh->fitsShaderStorage();
         });
}

bool PixelCounter::computeCounts(const RenderTarget& target,
                                 std::span<const MeshInstance> instances, size_t total) {
  const auto bytes = static_cast<GLsizeiptr>(total * sizeof(uint32_t));
  if (total > capacity_) {
    const size_t wanted = total + total / 4;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    counts_ = GlBuffer(name);
    capacity_ = 0;
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(wanted * sizeof(uint32_t)), nullptr, 0);
    if (!takeGlErrors().empty()) return false;
    capacity_ = wanted;
  }
  const GLuint zero = 0;
  glClearNamedBufferSubData(counts_.name(), GL_R32UI, 0, bytes, GL_RED_INTEGER, GL_UNSIGNED_INT,
                            &zero);
  glUseProgram(program_.name());
  glBindImageTexture(0, target.itemTexture(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, counts_.name());
  const auto width = static_cast<GLuint>(target.size().width);
  const auto height = static_cast<GLuint>(target.size().height);
  uint32_t firstItem = 1;
  uint32_t firstCount = 0;
  for (const MeshInstance& instance : instances) {
    const auto faces = static_cast<uint32_t>(instance.mesh->triangleCount());
    if (faces > 0) {
      glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, instance.mesh->cornerBuffer());
      glUniform1ui(0, firstItem);
      glUniform1ui(1, faces);
      glUniform1ui(2, firstCount);
      glDispatchCompute((width + kGroupSide - 1) / kGroupSide,
                        (height + kGroupSide - 1) / kGroupSide, 1);
    }
    firstItem += faces;
    firstCount += static_cast<uint32_t>(instance.mesh->vertexCount());
  }
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  return true;
}

bool PixelCounter::readBackInto(ReadBack& from, size_t total) {
  if (total > from.capacity) {
    const size_t wanted = total + total / 4;
    const auto bytes = static_cast<GLsizeiptr>(wanted * sizeof(uint32_t));
    const GLbitfield access = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    from = {GlBuffer(name), nullptr, 0};
    glNamedBufferStorage(name, bytes, nullptr, access | GL_CLIENT_STORAGE_BIT);
    from.mapped = static_cast<const uint32_t*>(glMapNamedBufferRange(name, 0, bytes, access));
    if (!takeGlErrors().empty() || from.mapped == nullptr) return false;
    from.capacity = wanted;
  }
  glCopyNamedBufferSubData(counts_.name(), from.buffer.name(), 0, 0,
                           static_cast<GLsizeiptr>(total * sizeof(uint32_t)));
  return true;
}

bool PixelCounter::start(const RenderTarget& target, std::span<const MeshInstance> instances,
                         uint64_t tag, uint32_t times) {
  if (started_.size() >= kMostUnderWay) return false;
  Started started;
  started.counts.tag = tag;
  started.times = times;
  size_t total = 0;
  for (const MeshInstance& instance : instances) {
    started.counts.changeCounts.push_back(instance.mesh->changeCount());
    total += instance.mesh->vertexCount();
  }
  timer_.begin();
  bool computed = false;
  if (canCompute(instances) && computeCounts(target, instances, total)) {
    if (!spare_.empty()) {
      started.from = std::move(spare_.back());
      spare_.pop_back();
    }
    computed = readBackInto(started.from, total);
  }
  timer_.end();
  if (computed) {
    for (const MeshInstance& instance : instances)
      started.counts.pixels.emplace_back(instance.mesh->vertexCount());
    started.arrived = GlSync(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0));
  } else {
    target.readItems(items_);
    countPixels(items_, instances, started.counts.pixels);
  }
  started_.push_back(std::move(started));
  return true;
}

bool PixelCounter::hasArrived(Started& started) const {
  if (started.arrived.get() == nullptr) return true;
  const GLenum state = glClientWaitSync(started.arrived.get(), GL_SYNC_FLUSH_COMMANDS_BIT, 0);
  return state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED;
}

bool PixelCounter::take(PixelCounts& into) {
  size_t arrived = 0;
  while (arrived < started_.size() && hasArrived(started_[arrived])) ++arrived;
  if (arrived == 0) return false;
  Started& latest = started_[arrived - 1];
  const uint32_t* from = latest.arrived.get() == nullptr ? nullptr : latest.from.mapped;
  for (std::vector<uint32_t>& pixels : latest.counts.pixels) {
    if (from != nullptr) {
      std::copy(from, from + pixels.size(), pixels.begin());
      from += pixels.size();
    }
    if (latest.times != 1)
      for (uint32_t& count : pixels) count *= latest.times;
  }
  std::swap(into, latest.counts);
  for (size_t i = 0; i < arrived; ++i) {
    if (started_.front().from.capacity > 0) spare_.push_back(std::move(started_.front().from));
    started_.pop_front();
  }
  return true;
}

void PixelCounter::count(const RenderTarget& target, std::span<const MeshInstance> instances,
                         std::vector<std::vector<uint32_t>>& counts) {
  const size_t total = vertexSlotsOf(instances);
  if (!canCompute(instances) || !computeCounts(target, instances, total)) {
    target.readItems(items_);
    countPixels(items_, instances, counts);
    return;
  }
  counts.resize(instances.size());
  size_t first = 0;
  for (size_t i = 0; i < instances.size(); ++i) {
    const size_t slots = instances[i].mesh->vertexCount();
    counts[i].resize(slots);
    if (slots > 0)
      glGetNamedBufferSubData(counts_.name(), static_cast<GLintptr>(first * sizeof(uint32_t)),
                              static_cast<GLsizeiptr>(slots * sizeof(uint32_t)), counts[i].data());
    first += slots;
  }
}

void PixelCounter::count(const RenderTarget& target, const GpuMesh& mesh,
                         std::vector<uint32_t>& counts) {
  std::vector<std::vector<uint32_t>> all(1);
  all[0].swap(counts);
  count(target, std::array{MeshInstance{&mesh}}, all);
  counts.swap(all[0]);
}

size_t PixelCounter::byteCount() const {
  size_t counts = capacity_;
  for (const ReadBack& from : spare_) counts += from.capacity;
  for (const Started& started : started_) counts += started.from.capacity;
  return counts * sizeof(uint32_t);
}

void countPixels(std::span<const uint32_t> items, std::span<const Triangle> corners,
                 size_t vertexCount, std::vector<uint32_t>& counts) {
  counts.assign(vertexCount, 0);
  size_t at = 0;
  while (at < items.size()) {
    const uint32_t item = items[at];
    const size_t begin = at;
    while (at < items.size() && items[at] == item) {
      ++at;
    }
    if (item == 0 || item > corners.size()) {
      continue;
    }
    for (const uint32_t vertex : corners[item - 1]) {
      if (vertex < vertexCount) {
        counts[vertex] += static_cast<uint32_t>(at - begin);
      }
    }
  }
}

void countPixels(std::span<const uint32_t> items, std::span<const MeshInstance> instances,
                 std::vector<std::vector<uint32_t>>& counts) {
  counts.resize(instances.size());
  if (instances.size() == 1) {
    const GpuMesh& mesh = *instances[0].mesh;
    countPixels(items, mesh.corners(), mesh.vertexCount(), counts[0]);
    return;
  }
  for (size_t i = 0; i < instances.size(); ++i)
    counts[i].assign(instances[i].mesh->vertexCount(), 0);
  for (size_t at = 0; at < items.size();) {
    const size_t begin = at;
    while (at < items.size() && items[at] == items[begin]) ++at;
    const std::optional<SceneFace> seen = faceOfItem(instances, items[begin]);
    if (!seen) continue;
    for (const uint32_t vertex : instances[seen->instance].mesh->corners()[seen->face])
      counts[seen->instance][vertex] += static_cast<uint32_t>(at - begin);
  }
}

}  // namespace meshfront
