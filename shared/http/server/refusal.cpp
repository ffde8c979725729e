#include "shared/http/server/refusal.h"

#include "shared/http/problem.h"

namespace meshfront {
namespace {

HttpResponse readableProblem(unsigned status, const std::string& detail) {
  HttpResponse response = problem(status, detail);
  response.set("Access-Control-Allow-Origin", "*");
  return response;
}

}  // namespace

HttpResponse refusalResponse(Refusal refusal) {
  HttpResponse response =
      refusal == Refusal::address
          ? readableProblem(429, "too many connections from this address; use fewer of them")
          : readableProblem(503, "the server is busy; try again later");
  response.set("Retry-After", "2");
  return response;
}

HttpResponse defectResponse(const RequestDefect& defect, const ServerLimits& limits) {
  std::string detail = defect.detail;
  if (defect.status == 431) detail += ": more than " + std::to_string(limits.maxHeader) + " octets";
  return readableProblem(defect.status, detail);
}

Refusal refusalFor(const RequestDefect& defect) {
  if (defect.status == 414) return Refusal::target;
  return defect.status == 431 ? Refusal::header : Refusal::malformed;
}

HttpResponse tooSlowResponse() {
  return readableProblem(408, "the request took too long to arrive; send it again");
}

}  // namespace meshfront
