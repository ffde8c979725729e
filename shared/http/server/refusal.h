// What the server itself answers, before or instead of the handler.
#pragma once

#include "shared/http/message.h"
#include "shared/http/server/front_metrics.h"
#include "shared/http/server/request_head.h"
#include "shared/http/server/server_limits.h"

namespace meshfront {

// 429 and 503, for requests that there is no room for.
[[nodiscard]] HttpResponse refusalResponse(Refusal refusal);
// 400, 414, 431, 501, 505, for what is no request.
[[nodiscard]] HttpResponse defectResponse(const RequestDefect& defect, const ServerLimits& limits);
[[nodiscard]] Refusal refusalFor(const RequestDefect& defect);
// 408
[[nodiscard]] HttpResponse tooSlowResponse();

}  // namespace meshfront
