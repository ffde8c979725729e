#include "shared/http/record_service.h"

#include <algorithm>
#include <cstdio>

#include "shared/http/conditional_request.h"
#include "shared/http/problem.h"
#include "shared/store/entity_tag.h"

namespace meshfront {
namespace {

constexpr const char* kImmutable = "public, max-age=31536000, immutable, no-transform";
constexpr const char* kShort = "public, max-age=10";
constexpr const char* kBinary = "application/octet-stream";

void setAge(HttpResponse& response, std::optional<std::chrono::seconds> age) {
  if (age) response.set("Age", std::to_string(std::max<int64_t>(age->count(), 0)));
}

HttpResponse immutableResponse(HeldBytes content, std::string etag,
                               std::optional<std::chrono::seconds> age) {
  HttpResponse response;
  response.content = std::move(content);
  response.set("Content-Type", kBinary);
  response.set("Cache-Control", kImmutable);
  response.set("ETag", std::move(etag));
  setAge(response, age);
  return response;
}

HttpResponse describedResponse(Described described) {
  HttpResponse response;
  response.content = std::move(described.json);
  response.set("Content-Type", "application/json");
  response.set("Cache-Control", kShort);
  response.set("ETag", documentTag(response.content.bytes()));
  setAge(response, described.age);
  return response;
}

HttpResponse plainResponse(unsigned status, const char* contentType, std::string text) {
  HttpResponse response;
  response.status = status;
  response.content = HeldBytes::of(std::move(text));
  response.set("Content-Type", contentType);
  response.set("Cache-Control", "no-store");
  return response;
}

HttpResponse optionsResponse(RouteKind kind) {
  HttpResponse response;
  response.status = 204;
  response.set("Allow", allowedMethods(kind));
  response.set("Access-Control-Allow-Methods", allowedMethods(kind));
  response.set("Access-Control-Allow-Headers", "Content-Type, If-None-Match");
  response.set("Access-Control-Max-Age", "86400");
  if (kind == RouteKind::querySplits) response.set("Accept-Query", kBinary);
  return response;
}

HttpResponse wrongMethod(RouteKind kind) {
  HttpResponse response =
      problem(405, std::string("this resource answers ") + allowedMethods(kind));
  response.set("Allow", allowedMethods(kind));
  return response;
}

bool isAllowed(std::string_view method, RouteKind kind) {
  if (kind == RouteKind::querySplits) return method == "QUERY";
  return method == "GET" || method == "HEAD";
}

// The type alone; parameters of a binary type mean nothing.
bool isBinary(std::string_view contentType) {
  const std::string_view type = contentType.substr(0, contentType.find(';'));
  const size_t end = type.find_last_not_of(" \t");
  const std::string_view trimmed = type.substr(0, end == std::string_view::npos ? 0 : end + 1);
  const std::string_view expected = kBinary;
  return std::equal(trimmed.begin(), trimmed.end(), expected.begin(), expected.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

const std::string* find(const HttpResponse& response, std::string_view name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return &value;
  return nullptr;
}

// RFC 9211. A set of records can be in the cache in part.
const char* cacheStatus(uint64_t records, uint64_t fetched) {
  if (fetched == 0) return "meshfront; hit";
  return fetched < records ? "meshfront; fwd=partial" : "meshfront; fwd=miss";
}

}  // namespace

RecordService::RecordService(Catalogue& catalogue, Metrics& metrics, Options options)
    : catalogue_(catalogue),
      metrics_(metrics),
      options_(std::move(options)),
      ids_(metrics.counter("meshfront_requested_ids_total",
                           "Node IDs in requests for records, descendants not counted.")),
      records_(metrics.counter("meshfront_records_total", "Records in answers.")),
      recordBytes_(metrics.counter("meshfront_record_bytes_total",
                                   "Bytes of answers with records, checksums included.")),
      chunkBytes_(metrics.counter("meshfront_chunk_bytes_total", "Bytes of chunks in answers.")) {
  for (unsigned kind = 0; kind < kRouteKinds; ++kind)
    for (size_t i = 0; i < kStatuses.size(); ++i)
      requests_[kind][i] =
          &metrics.counter("meshfront_requests_total", "Requests answered, by resource and status.",
                           std::string("route=\"") + routeName(static_cast<RouteKind>(kind)) +
                               "\",status=\"" + std::to_string(kStatuses[i]) + "\"");
}

std::optional<HttpResponse> RecordService::answerAtOnce(const HttpRequest& request) {
  const Route route = parseTarget(request.target);
  auto response = respond(request, route, Waiting::refused);
  if (response) return finish(std::move(*response), request, route);
  const ErrorCode code = response.error().code;
  if (code == ErrorCode::unavailable || code == ErrorCode::timedOut) return std::nullopt;
  return finish(problemFor(response.error()), request, route);
}

HttpResponse RecordService::answer(const HttpRequest& request) {
  const Route route = parseTarget(request.target);
  auto response = respond(request, route, Waiting::allowed);
  return finish(response ? std::move(*response) : problemFor(response.error()), request, route);
}

HttpResponse RecordService::overloaded(const HttpRequest& request) {
  HttpResponse response = problem(503, "too many requests are waiting; try again later");
  response.set("Retry-After", "1");
  return finish(std::move(response), request, parseTarget(request.target));
}

Result<HttpResponse> RecordService::respond(const HttpRequest& request, const Route& route,
                                            Waiting waiting) {
  if (request.target.size() > options_.maxTarget)
    return problem(414, "the URL is longer than " + std::to_string(options_.maxTarget) +
                            " octets; send the set by QUERY");
  if (route.kind == RouteKind::unknown) return problem(404, "no such resource");
  if (request.method == "OPTIONS") return optionsResponse(route.kind);
  if (!isAllowed(request.method, route.kind)) return wrongMethod(route.kind);
  if (request.contentTooLarge)
    return problem(413, "the content is longer than " + std::to_string(options_.maxContent) +
                            " octets; ask for fewer nodes at a time");
  const bool takesQuery = route.kind == RouteKind::splits || route.kind == RouteKind::querySplits;
  if (route.hasQuery && !takesQuery) return problem(400, "this resource takes no query");
  return dispatch(request, route, waiting);
}

Result<HttpResponse> RecordService::dispatch(const HttpRequest& request, const Route& route,
                                             Waiting waiting) {
  switch (route.kind) {
    case RouteKind::health:
      return plainResponse(200, "text/plain; charset=utf-8", "ok\n");
    case RouteKind::ready:
      if (catalogue_.ready(waiting))
        return plainResponse(200, "text/plain; charset=utf-8", "ready\n");
      if (waiting == Waiting::refused) return fail(ErrorCode::unavailable, "not known yet");
      return problem(503, "not ready");
    case RouteKind::metrics:
      return plainResponse(200, "text/plain; version=0.0.4; charset=utf-8", metrics_.text());
    case RouteKind::catalogue:
      return catalogue_.list(waiting).map(describedResponse);
    case RouteKind::mesh:
      return catalogue_.describe(route.mesh, waiting).map(describedResponse);
    default:
      break;
  }
  const auto opened = catalogue_.open(route.mesh, route.revision, waiting);
  if (!opened) return tl::unexpected(opened.error());
  RecordStore& store = **opened;
  if (route.kind == RouteKind::splits || route.kind == RouteKind::querySplits)
    return splits(request, route, store, waiting);
  Result<HeldBytes> content;
  std::string resource = "base";
  if (route.kind == RouteKind::base) content = store.base(waiting);
  if (route.kind == RouteKind::chunks) {
    resource = "chunks";
    content = store.chunkIndex(waiting);
  }
  if (route.kind == RouteKind::chunk) {
    const auto number = canonicalNumber(route.last);
    if (!number) return problem(400, "a chunk's number is a decimal number without leading zeros");
    resource = "chunks/" + std::to_string(*number);
    content = store.chunk(*number, waiting);
    if (content) chunkBytes_.add(content->bytes().size());
  }
  if (!content) return tl::unexpected(content.error());
  return immutableResponse(std::move(*content),
                           constantTag(route.revision, resourceKey(route.revision, resource)),
                           store.age());
}

Result<HttpResponse> RecordService::splits(const HttpRequest& request, const Route& route,
                                           RecordStore& store, Waiting waiting) {
  const bool byQuery = route.kind == RouteKind::querySplits;
  if (byQuery && !isBinary(request.contentType)) {
    HttpResponse response = problem(415, "the set comes as application/octet-stream");
    response.set("Accept-Query", kBinary);
    return response;
  }
  const auto maxLevel = store.maxLevel();
  if (!maxLevel) return tl::unexpected(maxLevel.error());
  const size_t maxWanted = options_.limits.maxWanted;
  const auto set =
      byQuery ? parseSplitQuery(request.content, route.hasQuery, route.query, *maxLevel, maxWanted)
              : parseSplitUrl(route.last, route.hasQuery, route.query, *maxLevel, maxWanted);
  if (!set)
    return problem(set.error().code == ErrorCode::tooLarge ? 413 : 400, set.error().message);
  if (set->expansion.levels > options_.maxLevels)
    return problem(413, "more than " + std::to_string(options_.maxLevels) +
                            " levels; ask for fewer at a time");

  auto answer = store.collect(set->wanted, set->expansion, options_.limits, waiting);
  if (!answer) return tl::unexpected(answer.error());
  ids_.add(set->wanted.size());
  records_.add(answer->records);
  recordBytes_.add(answer->bytes.size());
  const std::optional<uint64_t> fetched = answer->fetched;
  const uint64_t records = answer->records;
  const std::span<const uint8_t> bitstring = byQuery ? request.content : set->fromUrl;
  std::string etag =
      recordsTag(answer->bytes, recordsKey(route.revision, bitstring, set->expansion));
  HttpResponse response =
      immutableResponse(HeldBytes::of(std::move(answer->bytes)), std::move(etag), store.age());
  if (fetched) response.set("Cache-Status", cacheStatus(records, *fetched));
  if (byQuery) {
    std::string target = splitTarget(route.mesh, route.revision, request.content, set->expansion);
    if (target.size() <= std::min(options_.maxTarget, kMaxNamedOctets))
      response.set("Content-Location", std::move(target));
  }
  return response;
}

HttpResponse RecordService::finish(HttpResponse response, const HttpRequest& request,
                                   const Route& route) {
  if (response.status == 200 && !request.ifNoneMatch.empty()) {
    const std::string* etag = find(response, "ETag");
    if (etag != nullptr && ifNoneMatchHolds(request.ifNoneMatch, *etag)) {
      response.status =
          304;  // keeps the content's length, as HEAD does; the front sends none of it
      std::erase_if(response.headers, [](const auto& field) {
        return std::string_view(field.first) == "Content-Type";
      });
    }
  }
  response.set("Access-Control-Allow-Origin", "*");
  if (!options_.via.empty()) {
    const std::string before = options_.viaBefore ? options_.viaBefore() : std::string();
    response.set("Via", before.empty() ? options_.via : before + ", " + options_.via);
  }
  size_t status = 0;
  while (status + 1 < kStatuses.size() && kStatuses[status] != response.status) ++status;
  requests_[static_cast<unsigned>(route.kind)][status]->add();
  return response;
}

}  // namespace meshfront
