#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "server/http/body_budget.h"
#include "server/http/limits.h"
#include "server/http/message.h"
#include "server/http/message_head.h"
#include "server/http/router.h"

namespace graspdb {

/** How a body ended. */
enum class BodyEnd {
  kWhole,
  kBroken,    ///< Early, with broken chunks, or because it was not taken.
  kTimedOut,  ///< It came too slowly.
};

/** Is given the next bytes; says whether it wants more. */
using BodyTaker = std::function<bool(std::string_view)>;
/** Hands over a body, piece by piece, until it ends or is not taken. */
using BodySource = std::function<BodyEnd(const BodyTaker&)>;

/** Reads the body that an operation takes into `request`: into `body`, or, for
 a form, its files into `files` and its other fields into `query`.
 @param head  Of the request, whose fields `request` has, too.
 @param budget  Large bodies are held at its cost as long as the request's body
   is; it must outlive the request.
 @returns the answer when it is refused: 400, 408, 413, 415, or 503 when the
   budget is spent; nothing when all is well, or there is no body. */
std::optional<HttpResponse> ReadRequestBody(
    const MessageHead& head, BodyKind kind, const HttpLimits& limits,
    BodyBudget& budget, const BodySource& source, HttpRequest& request);

}  // namespace graspdb
