#include "tests/unit/mesh_service.h"

#include <cmath>
#include <numbers>

#include "encoder/simplification/simplify.h"
#include "shared/bits/base64url.h"
#include "shared/bits/bit_writer.h"
#include "shared/bits/crc32c.h"
#include "shared/hierarchy/tree_bitstring.h"

namespace meshfront {

TestMesh TestMesh::torus(uint32_t around, uint32_t across) {
  TestMesh mesh;
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around;
      const double b = 2 * std::numbers::pi * j / across;
      const double tube = 2'000 + 150 * std::sin(7 * a) * std::cos(5 * b);
      const double distance = 5'500 + tube * std::cos(b);
      mesh.positions.push_back({static_cast<int32_t>(8'000 + distance * std::cos(a)),
                                static_cast<int32_t>(8'000 + distance * std::sin(a)),
                                static_cast<int32_t>(8'000 + tube * std::sin(b))});
      const uint32_t nextI = (i + 1) % around * across;
      const uint32_t nextJ = (j + 1) % across;
      const uint32_t corner = i * across + j;
      mesh.triangles.push_back({corner, nextI + j, nextI + nextJ});
      mesh.triangles.push_back({corner, nextI + nextJ, i * across + nextJ});
    }
  }
  const Simplification log =
      simplify(mesh.positions, 0, mesh.triangles, mesh.triangles.size(), {0.01, 1});
  const VertexForest forest(mesh.positions, 0, log.collapses);
  mesh.coded = codeMesh({mesh.positions, 0, mesh.triangles, kDefaultQuantizationBits}, forest, 1);
  return mesh;
}

MeshService::MeshService(TestMesh mesh, std::string revisionName)
    : revision(std::move(revisionName)), knownRevision(revision), mesh_(std::move(mesh)) {
  const auto base = decodeBaseMesh(mesh_.coded.base);
  for (size_t i = 0; i < mesh_.coded.chunks.size(); ++i) {
    const auto chunk = decodeChunk(mesh_.coded.chunks[i], base->tables);
    for (const RecordEntry& entry : chunk->entries) records_.emplace(entry.id, Place{i, entry});
  }
}

FetchResponse MeshService::answer(const FetchRequest& request) const {
  FetchResponse response;
  response.status = 200;
  const std::string own = "/v1/meshes/torus";
  const std::string path = request.url.substr(request.url.find(own) + own.size());
  if (path.empty()) {
    MeshMetadata metadata;
    metadata.name = "torus";
    metadata.revision = revision;
    metadata.vertexCount = mesh_.positions.size();
    metadata.triangleCount = mesh_.triangles.size();
    metadata.splitCount = splitCount();
    metadata.maxLevel = 20;
    metadata.baseBytes = mesh_.coded.base.size();
    metadata.chunkCount = static_cast<uint32_t>(mesh_.coded.chunks.size());
    for (const auto& chunk : mesh_.coded.chunks) metadata.chunkBytes += chunk.size();
    metadata.boundsMax = {16'000, 16'000, 16'000};
    const std::string json = toJson(metadata);
    response.body.assign(json.begin(), json.end());
  } else if (!path.starts_with("/" + knownRevision + "/")) {
    response.status = 404;
  } else if (path.ends_with("/base")) {
    response.body = mesh_.coded.base;
  } else if (path.ends_with("/chunks")) {
    response.body = mesh_.coded.chunkIndex;
  } else if (const size_t at = path.find("/chunks/"); at != std::string::npos) {
    response.body = mesh_.coded.chunks.at(std::stoul(path.substr(at + 8)));
  } else {
    response = records(request);
  }
  response.traffic = {1, 100 + request.content.size(), 200, response.body.size()};
  return response;
}

MeshService::Wanted MeshService::wantedBy(const FetchRequest& request) {
  Wanted wanted;
  const size_t begin = request.url.find("/splits") + 7;
  const size_t question = request.url.find('?');
  std::vector<uint8_t> bits = request.content;
  if (request.method == FetchRequest::Method::get)
    bits = *base64urlDecode(request.url.substr(begin + 1, question - begin - 1));
  wanted.nodes = *decodeTreeBitstring(bits, 1 << 20);
  const std::string parameter =
      question == std::string::npos ? "" : request.url.substr(question + 1);
  if (parameter.starts_with("levels="))
    wanted.expansion.levels = static_cast<uint32_t>(std::stoul(parameter.substr(7)));
  if (parameter.starts_with("significance="))
    wanted.expansion.significance = static_cast<uint8_t>(std::stoul(parameter.substr(13)));
  return wanted;
}

FetchResponse MeshService::records(const FetchRequest& request) const {
  FetchResponse response;
  const Wanted wanted = wantedBy(request);
  if (wanted.nodes.size() > mostNodes || (refusesExpansion && !wanted.expansion.none())) {
    response.status = 413;
    return response;
  }
  BitWriter out;
  const auto write = [&](const auto& self, const NodeId& id, unsigned generation) -> bool {
    const auto found = records_.find(id);
    if (found == records_.end()) return false;
    const auto& [chunk, entry] = found->second;
    out.append(mesh_.coded.chunks[chunk], entry.bitOffset, entry.bitLength);
    const auto goesOn = [&](bool leaf, unsigned level) {
      if (leaf) return false;
      return wanted.expansion.significance ? level <= *wanted.expansion.significance
                                           : generation < wanted.expansion.levels;
    };
    if (goesOn(entry.leftIsLeaf, entry.leftLevel)) self(self, id.child(false), generation + 1);
    if (goesOn(entry.rightIsLeaf, entry.rightLevel)) self(self, id.child(true), generation + 1);
    return true;
  };
  for (const NodeId& id : wanted.nodes) {
    if (!write(write, id, 0)) {
      response.status = 404;
      return response;
    }
  }
  response.status = 200;
  response.body = out.take();
  appendChecksum(response.body);
  return response;
}

}  // namespace meshfront
