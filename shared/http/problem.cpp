#include "shared/http/problem.h"

#include <nlohmann/json.hpp>

namespace meshfront {

std::string_view reasonPhrase(unsigned status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 501:
      return "Not Implemented";
    case 502:
      return "Bad Gateway";
    case 503:
      return "Service Unavailable";
    case 504:
      return "Gateway Timeout";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Error";
  }
}

HttpResponse problem(unsigned status, std::string_view detail) {
  HttpResponse response;
  response.status = status;
  response.set("Content-Type", "application/problem+json");
  // 404 is short-lived, so that a pointer to an old revision heals itself; the rest is for nobody
  // to keep.
  response.set("Cache-Control", status == 404 ? "public, max-age=10" : "no-store");
  const nlohmann::json body = {
      {"type", "about:blank"},
      {"title", reasonPhrase(status)},
      {"status", status},
      {"detail", detail},
  };
  response.content =
      HeldBytes::of(body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return response;
}

HttpResponse problemFor(const Error& error) {
  switch (error.code) {
    case ErrorCode::notFound:
      return problem(404, error.message);
    case ErrorCode::tooLarge:
      return problem(413, error.message);
    case ErrorCode::unavailable:
      return problem(502, "the service behind this proxy is not available; try again later");
    case ErrorCode::timedOut:
      return problem(504, "the service behind this proxy did not answer in time; try again later");
    case ErrorCode::overloaded: {
      HttpResponse response = problem(503, error.message);
      response.set("Retry-After", "1");
      return response;
    }
    case ErrorCode::invalid:
      break;
  }
  return problem(500, "the stored mesh is damaged; its operator has to restore it");
}

}  // namespace meshfront
