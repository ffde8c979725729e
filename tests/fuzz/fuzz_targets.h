// What is fuzzed: a function for each reader of untrusted bytes. Built by clang each becomes a
// program for libFuzzer (fuzz_entry.cpp, run.sh); the unit tests replay every seed of
// corpus/NAME/ through it.
//
// A target takes any bytes, gives whether the reader accepted them, and aborts where what came out
// breaks the reader's promises. Checksums, which would stop nearly every mutation, are appended by
// the target and are no part of its input.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace meshfront::fuzz {

using Bytes = std::span<const uint8_t>;

// A mesh file in each format, gzip, xz or Zstandard.
bool readPlyFile(Bytes input);
bool readObjFile(Bytes input);
bool readStlFile(Bytes input);
bool readOffFile(Bytes input);
bool readGltfFile(Bytes input);
bool readGlbFile(Bytes input);
bool decompressFile(Bytes input);
// The JSON of a catalogue's mesh.
bool readMetadata(Bytes input);
// A target and an If-None-Match field, a line each, then the content of a QUERY.
bool readRequest(Bytes input);
// How many octets come at a time, then those of a connection: requests of HTTP/1.1.
bool readHttp(Bytes input);
// Generations, length of the request's bitstring (2 bytes, little-endian), that bitstring, records.
bool readAnswer(Bytes input);
bool readBase(Bytes input);
bool readChunk(Bytes input);
bool readChunkIndex(Bytes input);
// The number of a base (fuzz_bases.h), then steps: what to do, a node (2 bytes), bits of a record.
bool refineMesh(Bytes input);
// Entries: which (0 metadata, 1 base, 2 chunk index, 3 report, 4 .. chunks), length (2 bytes,
// little-endian), content.
bool readPack(Bytes input);
// What the proxy makes of its upstream. Answers: status and whether a checksum or a base is added,
// ETag, Cache-Control and Age, a line each, length (2 bytes, little-endian), content.
bool readUpstream(Bytes input);

struct Target {
  std::string_view name;  // of its folder of seeds; its program is fuzz-NAME
  bool (*run)(Bytes input);
};
inline constexpr std::array kTargets{
    Target{"ply", readPlyFile},           Target{"obj", readObjFile},
    Target{"stl", readStlFile},           Target{"off", readOffFile},
    Target{"gltf", readGltfFile},         Target{"glb", readGlbFile},
    Target{"compressed", decompressFile}, Target{"metadata", readMetadata},
    Target{"request", readRequest},       Target{"http", readHttp},
    Target{"answer", readAnswer},         Target{"base", readBase},
    Target{"chunk", readChunk},           Target{"chunk-index", readChunkIndex},
    Target{"refine", refineMesh},         Target{"pack", readPack},
    Target{"upstream", readUpstream},
};

}  // namespace meshfront::fuzz
