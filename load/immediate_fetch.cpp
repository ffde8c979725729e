#include "load/immediate_fetch.h"

#include <chrono>
#include <future>
#include <memory>
#include <utility>

#include "shared/program/interrupt.h"

namespace meshfront {
namespace {

constexpr std::chrono::milliseconds kLookAtSignals{100};
constexpr int kMostLooks = 300;

}  // namespace

Result<FetchResponse> fetchNow(FetchRequest request, Transport& transport) {
  const std::string url = request.url;
  const auto answered = std::make_shared<std::promise<FetchResponse>>();
  std::future<FetchResponse> answer = answered->get_future();
  const FetchId id = transport.send(std::move(request), [answered](FetchResponse response) {
    answered->set_value(std::move(response));
  });
  const bool ending = interrupted();  // already: then what is asked for belongs to the end
  for (int looks = 0; answer.wait_for(kLookAtSignals) != std::future_status::ready; ++looks) {
    const bool givenUp = interrupted() && !ending;
    if (looks < kMostLooks && !givenUp) continue;
    transport.cancel(id);
    return fail(ErrorCode::timedOut,
                url + (givenUp ? " was not waited for: interrupted" : " does not answer"));
  }
  FetchResponse response = answer.get();
  if (response.status == 0) return tl::unexpected(std::move(response.error));
  return response;
}

}  // namespace meshfront
