#include "shared/store/entity_tag.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>

#include "shared/bits/crc32c.h"

namespace meshfront {
namespace {

constexpr size_t kDigestDigits = 32;
constexpr size_t kKeyDigits = 8;

std::string hexOf(std::span<const uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(bytes.size() * 2);
  for (const uint8_t byte : bytes) {
    text.push_back(kDigits[byte >> 4]);
    text.push_back(kDigits[byte & 15]);
  }
  return text;
}

std::string hexOf(uint32_t key) {
  const std::array bytes{static_cast<uint8_t>(key >> 24), static_cast<uint8_t>(key >> 16),
                         static_cast<uint8_t>(key >> 8), static_cast<uint8_t>(key)};
  return hexOf(bytes);
}

std::span<const uint8_t> bytesOf(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

bool isHex(std::string_view text, size_t digits) {
  return text.size() == digits && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

// What stands between the quotes; empty for a weak tag and for none.
std::string_view unquoted(std::string_view tag) {
  if (tag.size() < 2 || tag.front() != '"' || tag.back() != '"') return {};
  return tag.substr(1, tag.size() - 2);
}

}  // namespace

uint32_t resourceKey(std::string_view revision, std::string_view resource) {
  return crc32c(bytesOf(resource), crc32c(bytesOf("/"), crc32c(bytesOf(revision))));
}

uint32_t recordsKey(std::string_view revision, std::span<const uint8_t> bitstring,
                    const Expansion& expansion) {
  std::string more;
  if (expansion.significance) {
    more = "s" + std::to_string(*expansion.significance);
  } else if (expansion.levels > 0) {
    more = "l" + std::to_string(expansion.levels);
  }
  return crc32c(bytesOf(more), crc32c(bitstring, resourceKey(revision, "splits/")));
}

std::string documentTag(std::span<const uint8_t> content) {
  std::array<uint8_t, EVP_MAX_MD_SIZE> digest{};
  EVP_Digest(content.data(), content.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  return '"' + hexOf(std::span(digest).first(kDigestDigits / 2)) + '"';
}

std::string constantTag(std::string_view revision, uint32_t key) {
  return std::string(1, '"').append(revision).append("-").append(hexOf(key)).append(1, '"');
}

std::string recordsTag(std::span<const uint8_t> content, uint32_t key) {
  return '"' + hexOf(content.last(std::min(content.size(), kChecksumBytes))) + '-' +
         std::to_string(content.size()) + '-' + hexOf(key) + '"';
}

bool isTagOfOtherDocument(std::string_view tag, std::span<const uint8_t> content) {
  return isHex(unquoted(tag), kDigestDigits) && tag != documentTag(content);
}

bool isTagOfOtherResource(std::string_view tag, uint32_t key) {
  const std::string_view text = unquoted(tag);
  const size_t first = text.find('-');
  const size_t last = text.rfind('-');
  if (first == std::string_view::npos || !isHex(text.substr(last + 1), kKeyDigits)) return false;
  const std::string_view head = text.substr(0, first);
  const bool isConstant = first == last && isHex(head, kDigestDigits);
  const bool isRecords = first != last && isHex(head, 2 * kChecksumBytes) &&
                         text.substr(first + 1, last - first - 1).find_first_not_of("0123456789") ==
                             std::string_view::npos;
  return (isConstant || isRecords) && text.substr(last + 1) != hexOf(key);
}

}  // namespace meshfront
