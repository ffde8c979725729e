// Whether an answer came out of a cache on the way, as far as its headers tell.
#pragma once

#include "shared/receiver/transport.h"

namespace meshfront {

// By Cache-Status (RFC 9211: nginx and Varnish as deploy/ has them), else X-Cache (Squid), else Age
// (RFC 9111). Not by the Age of meshfront-proxy, which is that of its copy of the mesh: it puts
// answers together from records, some of which it may have fetched just now.
[[nodiscard]] bool cameFromCache(const FetchResponse& response);

}  // namespace meshfront
