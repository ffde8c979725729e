// How much memory encoding takes, told before it is taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace meshfront {

struct MeshSize {
  uint64_t vertices = 0;
  uint64_t triangles = 0;
  bool colours = false;  // of the vertices
  bool normals = false;
};

// Bytes of the process at the height of each phase. With V vertices and F triangles, about 2 V:
//
// | phase | bytes | a vertex |
// |---|---|---|
// | read | file + 24 V + 12 F | 48 and the file |
// | clean | 56 V + 54 F | 164 |
// | simplify | 12 V + 12 F + the larger of 16 V + 84 F and 96 V + 48 F | 228 |
// | hierarchy | 92 V + 12 F | 116 |
// | code | 104 V + 40 F | 184 |
//
// and 8 MiB for the program. A vertex's colour takes 4 and its normal 12 while reading and
// cleaning, both together 8 later. Files whose triangles share no vertices (STL) need about 400 a
// vertex while they are welded. The largest phase is within 5 % of what was measured for scans of
// 0.1 to 1.4 million vertices; the others within 10 %, but for cleaning, which takes rather less.
struct MemoryEstimate {
  uint64_t read = 0;
  uint64_t clean = 0;
  uint64_t simplify = 0;
  uint64_t hierarchy = 0;
  uint64_t code = 0;
  [[nodiscard]] uint64_t peak() const;
};

// `fileBytes`: 0 once the file has been read.
[[nodiscard]] MemoryEstimate estimateMemory(const MeshSize& size, uint64_t fileBytes);

// What the first bytes of a PLY or binary STL file say that it holds; nothing if they do not say,
// as in other formats. Untrusted: at most as much as the file's bytes can hold.
[[nodiscard]] std::optional<MeshSize> promisedSize(const std::filesystem::path& path);

}  // namespace meshfront
