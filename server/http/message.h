#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/** @file
 A request and its answer as values, free of any HTTP library. */

namespace graspdb {

/** One part of a multipart/form-data body. */
struct FormPart {
  std::string name;
  std::string filename;      ///< Empty when the part is a plain field.
  std::string content_type;  ///< Empty when not stated.
  std::string content;

  bool operator==(const FormPart&) const = default;
};

using TextPairs = std::vector<std::pair<std::string, std::string>>;

/** A request whose framing, path and query have been checked and decoded. */
struct HttpRequest {
  std::string id;      ///< Of this request, in logs and answers.
  std::string method;  ///< HEAD arrives as GET.
  std::string path;    ///< Decoded, for messages.
  std::map<std::string, std::string> path_parameters;  ///< Decoded.
  TextPairs query;  ///< Decoded, in order; form fields of an upload included.
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  std::string body;                            ///< Empty for multipart bodies.
  std::vector<FormPart> files;  ///< Parts of a multipart body with a file.
  std::shared_ptr<void> held;   ///< What body and files take of a budget.
  std::stop_token stop;         ///< Requested when the server shuts down.

  /** Frees body and files: for who goes on for long without them. */
  void DropBody() {
    std::string().swap(body);
    std::vector<FormPart>().swap(files);
    held.reset();
  }

  /** @returns The field's value, or an empty view. `name` in lower case. */
  std::string_view FindHeader(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string_view() : found->second;
  }
};

/** An answer. */
struct HttpResponse {
  int status{200};
  std::string content_type{"application/json"};
  std::string body;
  TextPairs headers{};  ///< Beside those that the server itself sets.
  /** Stages with their milliseconds, for Server-Timing. */
  std::vector<std::pair<std::string, double>> timings{};
  /** Instead of `body`, a body that comes in pieces: the next one, waited for
   as long as it takes, or nothing at its end. Called by one thread. */
  std::function<std::optional<std::string>()> next_piece{};
};

}  // namespace graspdb
