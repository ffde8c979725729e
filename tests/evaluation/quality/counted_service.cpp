#include "tests/evaluation/quality/counted_service.h"

#include <string>
#include <utility>

#include "shared/http/server/response_head.h"
#include "shared/store/pack_store.h"

namespace meshfront::evaluation {
namespace {

// As long as any: the viewer was counted against this address.
constexpr const char* kServiceOrigin = "http://127.0.0.1:8080";
constexpr size_t kIndexBytes = size_t{1} << 30;

// What the viewer's transport sends in front of the content.
size_t requestHeadBytes(const FetchRequest& request, std::string_view target) {
  const bool query = request.method == FetchRequest::Method::query;
  std::string head = std::string(query ? "QUERY " : "GET ") + std::string(target) +
                     " HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nUser-Agent: meshfront\r\n";
  if (query)
    head += "Content-Type: " + request.contentType +
            "\r\nContent-Length: " + std::to_string(request.content.size()) + "\r\n";
  return head.size() + 2;
}

}  // namespace

class CountedService::OneMesh final : public Catalogue {
 public:
  explicit OneMesh(const std::shared_ptr<const Pack>& pack)
      : json_(HeldBytes::of(toJson(pack->metadata()))),
        store_(std::make_shared<PackStore>(pack, std::make_shared<MemoryBudget>(kIndexBytes))) {}
  [[nodiscard]] Result<Described> list(Waiting) override { return Described{json_, std::nullopt}; }
  [[nodiscard]] Result<Described> describe(std::string_view, Waiting) override {
    return Described{json_, std::nullopt};
  }
  [[nodiscard]] Result<std::shared_ptr<RecordStore>> open(std::string_view, std::string_view,
                                                          Waiting) override {
    return store_;
  }
  [[nodiscard]] bool ready(Waiting) override { return true; }

 private:
  HeldBytes json_;
  std::shared_ptr<RecordStore> store_;
};

CountedService::CountedService(std::shared_ptr<const Pack> pack)
    : catalogue_(std::make_unique<OneMesh>(pack)),
      service_(*catalogue_, metrics_, {}),
      url_{kServiceOrigin, "", pack->metadata().name},
      revision_(pack->metadata().revision) {}

CountedService::~CountedService() = default;

Result<ExchangeBytes> CountedService::exchange(const FetchRequest& request) {
  const std::string_view target =
      std::string_view(request.url).substr(std::string_view(kServiceOrigin).size());
  HttpRequest http;
  http.method = request.method == FetchRequest::Method::query ? "QUERY" : "GET";
  http.target = target;
  http.contentType = request.contentType;
  http.content = request.content;
  const HttpResponse response = service_.answer(http);
  if (response.status != 200)
    return fail("the service answered " + std::to_string(response.status) + " to a request for " +
                std::string(target.substr(0, 80)));
  DateField date;
  const size_t head = responseHead(response, date.text(0), Persistence::usual).size();
  fieldBytes_ = head;
  return ExchangeBytes{requestHeadBytes(request, target) + request.content.size(),
                       head + response.content.size()};
}

Result<ExchangeBytes> CountedService::metadata() {
  FetchRequest request;
  request.url = url_.metadata();
  return exchange(request);
}

Result<ExchangeBytes> CountedService::base() {
  FetchRequest request;
  request.url = url_.base(revision_);
  return exchange(request);
}

Result<ExchangeBytes> CountedService::records(const RecordRequest& request) {
  const Result<FetchRequest> http = toFetch(url_, revision_, request);
  if (!http) return tl::unexpected(http.error());
  return exchange(*http);
}

}  // namespace meshfront::evaluation
