#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "server/http/limits.h"
#include "server/http/message.h"

namespace graspdb {

/** The value of a parameter of a header field such as
 `multipart/form-data; boundary="a b"`; empty when absent. Name in lower case.
 */
std::string FindFieldParameter(std::string_view value, std::string_view name);

/** Takes a multipart/form-data body (RFC 7578) apart.
 @param content_type  The request's, with its boundary.
 @retval kInvalidArgument when the form is malformed.
 @retval kTooLarge when it has too many parts or a field is too long. */
Result<std::vector<FormPart>> ParseMultipart(std::string_view body,
                                             std::string_view content_type,
                                             const HttpLimits& limits);

}  // namespace graspdb
