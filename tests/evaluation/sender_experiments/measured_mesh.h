// A pack as both ways of streaming hold it: the sender-driven server's model and our service's
// store.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/camera/bounds.h"
#include "shared/camera/camera.h"
#include "shared/camera/camera_spec.h"
#include "shared/store/pack_store.h"
#include "tests/evaluation/sender_driven/sender_session.h"

namespace meshfront::evaluation {

inline constexpr PixelSize kPictureSize{500, 500};

struct MeasuredMesh {
  std::string name;
  std::shared_ptr<const Pack> pack;
  std::shared_ptr<PackStore> store;
  SenderModel model;
  Bounds bounds;

  [[nodiscard]] static Result<MeasuredMesh> open(const std::string& path);
  [[nodiscard]] ViewRequest view(const Camera& camera, float tolerance = 0) const {
    return ViewRequest::of(camera, kPictureSize, model.quantization(), tolerance);
  }
  // A preset, or any camera_spec.h.
  [[nodiscard]] Camera camera(const std::string& spec) const {
    return placeCamera(parseCameraSpec(spec).value_or(CameraSpec()), bounds, kPictureSize.aspect());
  }
};

// Octets that a sender-driven connection sends before the first split: the mesh's grid and bounds,
// the base mesh, the message's head.
[[nodiscard]] size_t helloBytes(const MeasuredMesh& mesh);

// What a service is asked for one after the other: URL spellings of sets of nodes.
struct SetRequest {
  std::string ids;  // base64url, as it stands in a URL
  size_t count = 0;
};
// `nodes` of the model, ascending, an antichain.
[[nodiscard]] Result<SetRequest> setRequest(const SenderModel& model,
                                            std::span<const uint32_t> nodes);
// The requests of a receiver that takes the whole mesh by significance, as many nodes at a time as
// ours asks for (adaptiveBatch()).
[[nodiscard]] Result<std::vector<SetRequest>> wholeMeshRequests(const SenderModel& model);
// The requests for these nodes (any order), generation by generation, 2,000 nodes at a time.
[[nodiscard]] Result<std::vector<SetRequest>> requestsFor(const SenderModel& model,
                                                          std::vector<uint32_t> nodes);

// Answers it as the service does; false on an error. The answer's bytes are counted in.
bool answerRequest(PackStore& store, const SetRequest& request, uint64_t& bytes);

// Of this thread.
[[nodiscard]] double processorSeconds();

}  // namespace meshfront::evaluation
