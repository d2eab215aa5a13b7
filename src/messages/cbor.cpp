#include "messages/cbor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "base/utf8.h"
#include "messages/cdr.h"
#include "messages/json.h"
#include "messages/typed_array.h"

namespace sandlot {
namespace {

using Json = nlohmann::json;

/// The major types of RFC 8949, section 3.1.
enum Major : unsigned { unsigned_integer, negative_integer, octets, text_string, array, map, tag, simple };
constexpr unsigned indefinite = 31;

class Writer : public CdrVisitor {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) { out_.clear(); }
  void open(const MessageInfo& info) override { head(map, info.fields.size()); }
  void close() override {}
  void field(const MessageField& field) override { text(field.name); }
  void open_list(std::size_t size) override { head(array, size); }
  void close_list() override {}
  void text(std::string_view text) override {
    std::size_t size = 0;
    each_utf8(text, [&](std::string_view piece) { size += piece.size(); });
    head(text_string, size);
    each_utf8(text, [&](std::string_view piece) { raw(std::as_bytes(std::span(piece))); });
  }
  void number(Wire type, const std::byte* value) override {
    if (type == Wire::boolean) return byte(*value != std::byte{0} ? 0xF5 : 0xF4);
    if (type == Wire::float32 || type == Wire::float64) {
      byte(type == Wire::float32 ? 0xFA : 0xFB);
      for (std::size_t i = size_of(type); i-- > 0;) out_.push_back(value[i]);  // network order
      return;
    }
    std::uint64_t bits = 0;
    std::memcpy(&bits, value, size_of(type));
    const bool is_signed = type == Wire::int8 || type == Wire::int16 || type == Wire::int32 ||
                           type == Wire::int64;
    const std::uint64_t sign = std::uint64_t{1} << (8 * size_of(type) - 1);
    if (is_signed && (bits & sign)) {
      bits |= ~(sign - 1);            // the sign, extended to 64 bits
      head(negative_integer, ~bits);  // -1 - n
    } else {
      head(unsigned_integer, bits);
    }
  }
  void numbers(Wire type, std::span<const std::byte> bytes) override {
    if (type == Wire::boolean) {
      head(array, bytes.size());
      for (const std::byte& value : bytes) number(type, &value);
      return;
    }
    if (const std::uint64_t number = typed_array_tag(type)) head(tag, number);
    head(octets, bytes.size());
    raw(bytes);
  }

 private:
  void byte(unsigned value) { out_.push_back(static_cast<std::byte>(value)); }
  void raw(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  void head(Major major, std::uint64_t n) {
    const unsigned type = static_cast<unsigned>(major) << 5;
    if (n < 24) return byte(type | static_cast<unsigned>(n));
    const unsigned power = n <= 0xFF ? 0 : n <= 0xFFFF ? 1 : n <= 0xFFFF'FFFF ? 2 : 3;
    byte(type | (24 + power));
    for (unsigned i = 1U << power; i-- > 0;) byte(static_cast<unsigned>(n >> (8 * i) & 0xFF));
  }
  std::vector<std::byte>& out_;
};

double from_half(std::uint64_t bits) {
  const int exponent = static_cast<int>(bits >> 10 & 31);
  const auto mantissa = static_cast<double>(bits & 1023);
  const double size = exponent == 0    ? std::ldexp(mantissa, -24)
                      : exponent != 31 ? std::ldexp(mantissa + 1024, exponent - 25)
                      : mantissa == 0  ? std::numeric_limits<double>::infinity()
                                       : std::numeric_limits<double>::quiet_NaN();
  return bits >> 15 ? -size : size;
}

class Parser {
 public:
  explicit Parser(std::span<const std::byte> bytes) : rest_(bytes) {}

  Result<Json> document() {
    SL_ASSIGN(Json value, item(0));
    if (!rest_.empty()) return Error{"bytes go on after the CBOR value"};
    return value;
  }

 private:
  struct Head {
    unsigned major = 0, info = 0;
    std::uint64_t n = 0;
  };
  static Error ends() { return {"CBOR ends too soon"}; }
  bool at_break() {
    if (rest_.empty() || rest_[0] != std::byte{0xFF}) return false;
    rest_ = rest_.subspan(1);
    return true;
  }
  Result<Head> head() {
    if (rest_.empty()) return ends();
    Head out{std::to_integer<unsigned>(rest_[0] >> 5), std::to_integer<unsigned>(rest_[0] & std::byte{31}),
             0};
    rest_ = rest_.subspan(1);
    if (out.info < 24) return out.n = out.info, out;
    if (out.info == indefinite) return out;
    if (out.info > 27) return Error{"is not a CBOR: a head of kind " + std::to_string(out.info)};
    const std::size_t size = std::size_t{1} << (out.info - 24);
    if (rest_.size() < size) return ends();
    for (std::size_t i = 0; i < size; ++i) out.n = out.n << 8 | std::to_integer<std::uint64_t>(rest_[i]);
    rest_ = rest_.subspan(size);
    return out;
  }
  /// The bytes of a byte string or a text, in one piece or in several.
  Status string(const Head& head, std::string& out) {
    if (head.info != indefinite) {
      if (head.n > rest_.size()) return ends();
      out.append(reinterpret_cast<const char*>(rest_.data()), static_cast<std::size_t>(head.n));
      rest_ = rest_.subspan(static_cast<std::size_t>(head.n));
      return {};
    }
    while (!at_break()) {
      SL_ASSIGN(const Head piece, this->head());
      if (piece.major != head.major || piece.info == indefinite)
        return Error{"is not a CBOR: a piece of a string"};
      SL_TRY(string(piece, out));
    }
    return {};
  }
  Result<Json> text(const Head& head) {
    std::string bytes;
    SL_TRY(string(head, bytes));
    std::string clean;
    each_utf8(bytes, [&](std::string_view piece) { clean += piece; });
    return Json(std::move(clean));
  }
  /// `tag_number`: of the typed array, 0 for none.
  Result<Json> bytes(const Head& head, std::uint64_t tag_number) {
    std::string all;
    SL_TRY(string(head, all));
    Json::binary_t binary(Json::binary_t::container_type(all.begin(), all.end()));
    // Tags 65..67, 73..75 and 81..82 are the big-endian forms of those 4 above (RFC 8746).
    const bool big = typed_array_type(tag_number) == Wire::uint8 &&
                     typed_array_type(tag_number + 4) != Wire::uint8 && tag_number != 68;
    if (big) tag_number += 4;
    if (const Wire type = typed_array_type(tag_number); type != Wire::uint8) {
      const std::size_t size = size_of(type);
      if (big)
        for (std::size_t i = 0; i + size <= binary.size(); i += size)
          std::reverse(binary.begin() + static_cast<std::ptrdiff_t>(i),
                       binary.begin() + static_cast<std::ptrdiff_t>(i + size));
      binary.set_subtype(tag_number);
    }
    return Json(std::move(binary));
  }
  Result<Json> simple_value(const Head& head) {
    switch (head.info) {
      case 20: return Json(false);
      case 21: return Json(true);
      case 22:
      case 23: return Json(nullptr);
      case 25: return Json(from_half(head.n));
      case 26: {
        const auto bits = static_cast<std::uint32_t>(head.n);
        float number = 0;
        std::memcpy(&number, &bits, sizeof number);
        return Json(static_cast<double>(number));
      }
      case 27: {
        double number = 0;
        std::memcpy(&number, &head.n, sizeof number);
        return Json(number);
      }
      default: return Error{"is not a CBOR: simple value " + std::to_string(head.info)};
    }
  }
  Result<Json> item(int depth) {
    if (depth > 64) return Error{"CBOR is nested deeper than 64 levels"};
    SL_ASSIGN(const Head head, this->head());
    const bool open_end = head.info == indefinite;
    if (open_end && (head.major < octets || head.major == tag))
      return Error{"is not a CBOR: a number without end"};
    switch (head.major) {
      case unsigned_integer: return Json(head.n);
      case negative_integer:
        if (head.n > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
          return Error{"CBOR has an integer below -2^63"};
        return Json(-1 - static_cast<std::int64_t>(head.n));
      case octets: return bytes(head, 0);
      case text_string: return text(head);
      case array: {
        Json list = Json::array();
        for (std::uint64_t i = 0; open_end ? !at_break() : i < head.n; ++i) {
          SL_ASSIGN(Json element, item(depth + 1));
          list.push_back(std::move(element));
        }
        return list;
      }
      case map: {
        Json object = Json::object();
        for (std::uint64_t i = 0; open_end ? !at_break() : i < head.n; ++i) {
          SL_ASSIGN(const Json key, item(depth + 1));
          if (!key.is_string()) return Error{"CBOR has a key that is not text"};
          SL_ASSIGN(Json value, item(depth + 1));
          object[key.get_ref<const std::string&>()] = std::move(value);
        }
        return object;
      }
      case tag: {
        // A tag before a byte string may make it a typed array; any other is passed over.
        if (rest_.empty() || (rest_[0] >> 5) != std::byte{octets}) return item(depth + 1);
        SL_ASSIGN(const Head inner, this->head());
        return bytes(inner, head.n);
      }
      default: return simple_value(head);
    }
  }
  std::span<const std::byte> rest_;
};

}  // namespace

Status cdr_to_cbor(const MessageInfo& info, std::span<const std::byte> cdr, std::vector<std::byte>& out) {
  Writer writer(out);
  return walk_cdr(info, cdr, writer);
}

Result<Json> parse_cbor(std::span<const std::byte> bytes) { return Parser(bytes).document(); }

Status read_cbor(const MessageInfo& info, std::span<const std::byte> bytes, void* message) {
  SL_ASSIGN(const Json document, parse_cbor(bytes));
  return read_json(info, document, message);
}

}  // namespace sandlot
