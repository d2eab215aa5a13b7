#pragma once
/// Error of a user, with its remedy; and Result, which carries a value or such an error.
///
/// Bugs never travel this way: they stop at SL_CHECK (base/check.h).
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/check.h"

namespace sandlot {

/// A place in a file. `line` and `column` count from 1; 0 means "not known" (the whole file, a flag).
struct Place {
  std::shared_ptr<const std::string> file;  ///< null: no file, e.g. a command-line flag
  int line = 0;
  int column = 0;
};

/// Renders `file:line:column`, leaving out what is not known.
std::string to_string(const Place& place);

/// One user error. `what` is the complaint, `fix` what would be right (may be empty).
struct Error {
  std::string what;
  std::string fix;
  Place place;
  std::string path;  ///< key path inside the file, `/robots/0/devices/laser/beams`

  /// `file:line:column: path: what; fix`, one line.
  std::string text() const;
};

/// A value or the Error that prevented it.
template <class T>
class [[nodiscard]] Result {
 public:
  using value_type = T;
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return content_.index() == 0; }
  T& value() & { return SL_CHECK_MSG(*this, error_text()), std::get<0>(content_); }
  const T& value() const& { return SL_CHECK_MSG(*this, error_text()), std::get<0>(content_); }
  T&& value() && { return SL_CHECK_MSG(*this, error_text()), std::get<0>(std::move(content_)); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  Error& error() { return SL_CHECK(!*this), std::get<1>(content_); }
  const Error& error() const { return SL_CHECK(!*this), std::get<1>(content_); }

 private:
  const char* error_text() const { return content_.index() == 1 ? std::get<1>(content_).what.c_str() : ""; }
  std::variant<T, Error> content_;
};

/// Success, or the Error that prevented it.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
  explicit operator bool() const { return !error_; }
  Error& error() { return SL_CHECK(!*this), *error_; }
  const Error& error() const { return SL_CHECK(!*this), *error_; }

 private:
  std::optional<Error> error_;
};

/// Returned by functions that only succeed or fail.
using Status = Result<void>;

/// Warnings gathered while files are read: each names its place and is reported once.
struct Diagnostics {
  std::vector<Error> warnings;
  void warn(Error warning) { warnings.push_back(std::move(warning)); }
};

}  // namespace sandlot

#define SL_CONCAT_(a, b) a##b
#define SL_CONCAT(a, b) SL_CONCAT_(a, b)
/// Returns the error of a failed Status or Result from the enclosing function.
#define SL_TRY(expression)                                                              \
  do {                                                                                  \
    if (auto sl_status = (expression); !sl_status) return std::move(sl_status).error(); \
  } while (false)
/// `SL_ASSIGN(auto x, f())`: x becomes f()'s value, or the enclosing function returns f()'s error.
#define SL_ASSIGN(declaration, expression)                                                         \
  auto SL_CONCAT(sl_result_, __LINE__) = (expression);                                             \
  if (!SL_CONCAT(sl_result_, __LINE__)) return std::move(SL_CONCAT(sl_result_, __LINE__).error()); \
  declaration = std::move(SL_CONCAT(sl_result_, __LINE__)).value()
