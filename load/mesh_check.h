// Whether there is a mesh to load at all, asked once before many receivers ask.
#pragma once

#include "shared/receiver/mesh_url.h"
#include "shared/receiver/transport.h"
#include "shared/result.h"

namespace meshfront {

// Fails where the URL cannot be right: it is refused (4xx), redirected, or answered by something
// that is no mesh; the message says which. A server that is away or out of order (5xx, 429) is
// no such thing, since receivers wait for it.
[[nodiscard]] Result<void> checkMesh(const MeshUrl& url, Transport& transport);

}  // namespace meshfront
