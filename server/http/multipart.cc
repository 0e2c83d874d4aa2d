#include "server/http/multipart.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/http/field_text.h"

namespace graspdb {
namespace {

Error Malformed(const std::string& what) {
  return {ErrorCode::kInvalidArgument,
          "The multipart/form-data body is malformed: " + what,
          "Send the file as curl -F mesh=@FILE does.", "mesh"};
}

/** Takes a quoted string, or text up to ";", off the front. */
std::string TakeValue(std::string_view& text) {
  std::string value;
  if (!text.starts_with('"')) {
    const size_t end = std::min(text.find(';'), text.size());
    value = TrimBlanks(text.substr(0, end));
    text.remove_prefix(end);
    return value;
  }
  size_t i = 1;
  for (; i < text.size() && text[i] != '"'; ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size() &&
                        (text[i + 1] == '"' || text[i + 1] == '\\');
    if (escape) ++i;
    value += text[i];
  }
  text.remove_prefix(std::min(i + 1, text.size()));
  return value;
}

/** Fills everything but the content from a part's header lines. */
Result<FormPart> ParsePartHead(std::string_view head) {
  FormPart part;
  bool disposed = false;
  while (!head.empty()) {
    const size_t end = head.find("\r\n");
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(end == std::string_view::npos ? head.size() : end + 2);
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos) return Malformed("a header line.");
    const std::string name = ToLowerAscii(line.substr(0, colon));
    const std::string_view value = TrimBlanks(line.substr(colon + 1));
    if (name == "content-type") {
      part.content_type = value;
    } else if (name == "content-disposition") {
      disposed = ToLowerAscii(value.substr(0, value.find(';'))) == "form-data";
      part.name = FindFieldParameter(value, "name");
      part.filename = FindFieldParameter(value, "filename");
    }
  }
  if (!disposed || part.name.empty()) return Malformed("a part has no name.");
  return part;
}

}  // namespace

std::string FindFieldParameter(std::string_view value, std::string_view name) {
  std::string_view rest = value.substr(std::min(value.find(';'), value.size()));
  while (rest.starts_with(';')) {
    rest = rest.substr(1);
    const size_t equals = rest.find('=');
    if (equals == std::string_view::npos) break;
    const std::string key = ToLowerAscii(TrimBlanks(rest.substr(0, equals)));
    rest.remove_prefix(equals + 1);
    const std::string found = TakeValue(rest);
    if (key == ToLowerAscii(name)) return found;
    rest.remove_prefix(std::min(rest.find(';'), rest.size()));
  }
  return "";
}

Result<std::vector<FormPart>> ParseMultipart(std::string_view body,
                                             std::string_view content_type,
                                             const HttpLimits& limits) {
  const std::string boundary = FindFieldParameter(content_type, "boundary");
  if (boundary.empty() || boundary.size() > 70) {
    return Malformed("its boundary has 1 to 70 characters.");
  }
  const std::string delimiter = "\r\n--" + boundary;
  // The first delimiter may lack the line break before it.
  if (body.starts_with(std::string_view(delimiter).substr(2))) {
    body.remove_prefix(delimiter.size() - 2);
  } else if (const size_t at = body.find(delimiter);
             at != std::string_view::npos) {
    body.remove_prefix(at + delimiter.size());
  } else {
    return Malformed("its boundary never appears.");
  }
  std::vector<FormPart> parts;
  while (!body.starts_with("--")) {
    if (parts.size() == limits.max_form_parts) {
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("A form has at most {} parts.", limits.max_form_parts)};
    }
    const size_t head_end =
        body.substr(0, limits.max_form_head_bytes).find("\r\n\r\n");
    const size_t end = head_end == std::string_view::npos
                           ? std::string_view::npos
                           : body.find(delimiter, head_end + 2);
    if (head_end == std::string_view::npos &&
        body.size() >= limits.max_form_head_bytes) {
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("The head of a form's part has at most {} bytes.",
                      limits.max_form_head_bytes)};
    }
    if (!body.starts_with("\r\n") || end == std::string_view::npos) {
      return Malformed("it ends early.");
    }
    if (head_end < 2) return Malformed("a part has no name.");
    GRASPDB_TRY(part, ParsePartHead(body.substr(2, head_end - 2)));
    const size_t content = std::min(head_end + 4, end);
    part.content = body.substr(content, end - content);
    if (part.filename.empty() &&
        part.content.size() > limits.max_form_field_bytes) {
      return Error{ErrorCode::kTooLarge,
                   fmt::format("A form field has at most {} bytes.",
                               limits.max_form_field_bytes),
                   "Send the mesh as a file: -F mesh=@FILE.", part.name};
    }
    parts.push_back(std::move(part));
    body.remove_prefix(end + delimiter.size());
  }
  return parts;
}

}  // namespace graspdb
