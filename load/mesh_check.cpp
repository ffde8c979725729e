#include "load/mesh_check.h"

#include <string_view>
#include <utility>

#include "load/immediate_fetch.h"
#include "shared/receiver/problem_details.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {
namespace {

constexpr size_t kMostCheckedBytes = size_t{1} << 20;  // as a receiver takes
constexpr unsigned kTimeout = 408;
constexpr unsigned kTooMany = 429;

}  // namespace

Result<void> checkMesh(const MeshUrl& url, Transport& transport) {
  FetchRequest request;
  request.url = url.metadata();
  request.maxBodyBytes = kMostCheckedBytes;
  const Result<FetchResponse> response = fetchNow(std::move(request), transport);
  if (!response) {
    const ErrorCode code = response.error().code;
    if (code == ErrorCode::unavailable || code == ErrorCode::timedOut) return {};
    return fail(code, url.metadata() + " is no mesh: " + response.error().message);
  }
  if (response->status >= 500) return {};
  if (response->status == kTimeout || response->status == kTooMany) return {};
  if (response->status == 404)
    return fail(ErrorCode::notFound, "there is no mesh '" + url.name + "' at " + url.origin +
                                         url.prefix + " (" + describeRefusal(*response) +
                                         "); the catalogue is " + url.origin + url.prefix +
                                         "/v1/meshes");
  if (response->status != 200)
    return fail(url.metadata() + " is refused: " + describeRefusal(*response));
  const auto metadata = metadataFromJson(std::string_view(
      reinterpret_cast<const char*>(response->body.data()), response->body.size()));
  if (!metadata)
    return fail(url.metadata() + " is no mesh of the v1 interface: " + metadata.error().message);
  return {};
}

}  // namespace meshfront
