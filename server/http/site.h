#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/http/message_head.h"

/** @file
 Pages of other sites, in a browser that can reach a server which others cannot.
 */

namespace graspdb {

/** Whether a server that listens there is for programs of this machine. */
bool IsLoopback(std::string_view host);

/** Says what is wrong with a request that a page of another site may have sent.
 @param for_this_machine  The server listens on loopback: of names, only
   localhost is its own. Any other that leads here is a trick, with which a page
   could read the answers (DNS rebinding).
 What changes something is refused, too, when it comes from a page, so it has an
 Origin, whose host is not the one that it was sent to, as Host or, through a
 front, as X-Forwarded-Host. */
std::optional<std::string> FindForeignSite(const MessageHead& head,
                                           bool for_this_machine);

}  // namespace graspdb
