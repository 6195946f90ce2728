// What a call's metadata says of it: which request it is, part of which trace, made by what.
#pragma once

#include <string>
#include <string_view>

#include <grpcpp/server_context.h>

namespace tet {

/// One step of a trace, as W3C Trace Context level 1 names it; lower-case hexadecimal.
struct TraceSpan {
  std::string trace_id;   ///< 32 digits; empty: the call is part of no trace
  std::string parent_id;  ///< 16 digits, the caller's span
  std::string span_id;    ///< 16 digits, this call
  std::string flags;      ///< 2 digits, as the caller sent them

  /// As a `traceparent` that says this span; empty without a trace.
  std::string traceparent() const;
};

/// A new span below what `traceparent` says; without a trace unless that is well formed.
TraceSpan span_below(std::string_view traceparent);

struct CallIdentity {
  std::string request_id;  ///< the caller's own if it sent a sensible one, else random
  TraceSpan span;
  std::string user_agent;  ///< printable and short
};

/// Reads a call's metadata.
CallIdentity identify(const grpc::CallbackServerContext& context);

/// Sends the request id, and the span where there is one, back as trailing metadata.
void tell_identity(const CallIdentity& identity, grpc::CallbackServerContext& context);

}  // namespace tet
