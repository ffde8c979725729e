// One request, waited for: what a run needs to know before its receivers start and after their end.
#pragma once

#include "shared/receiver/transport.h"
#include "shared/result.h"

namespace meshfront {

// The answer whatever its status. Fails where there is none within half a minute, and when an
// interrupt comes meanwhile (one that came before changes nothing).
[[nodiscard]] Result<FetchResponse> fetchNow(FetchRequest request, Transport& transport);

}  // namespace meshfront
