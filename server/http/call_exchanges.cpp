#include "server/http/call_exchanges.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/string_view.h>
#include <absl/strings/strip.h>

#include "proto/convert/status.h"
#include "server/http/forwarded_call.h"
#include "server/http/json_routes.h"
#include "tetstream/v1/grids.pb.h"

namespace tet {

namespace {

namespace v1 = ::tetstream::v1;

constexpr absl::string_view kGrpcWebType = "application/grpc-web+proto";
constexpr absl::string_view kUploadPath = "/v1/grids/";
constexpr absl::string_view kPassedOn[] = {"authorization", "x-request-id", "traceparent",
                                           "user-agent"};

grpc::ByteBuffer buffer_of(absl::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return {&slice, 1};
}

std::string text_of(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  std::string text;
  if (!buffer.Dump(&slices).ok()) return text;
  for (const grpc::Slice& slice : slices) {
    text.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return text;
}

std::string request_id_in(const Trailers& trailers) {
  for (const auto& [name, value] : trailers) {
    if (name == "x-request-id") return value;
  }
  return {};
}

/// What every request that becomes a call does.
class CallExchange : public Exchange, public CallSink {
 public:
  CallExchange(const HttpPlace& place, const RequestHead& head, AnswerStream& stream)
      : place_(place), stream_(stream) {
    order_.peer = stream.peer();
    for (const absl::string_view name : kPassedOn) {
      const std::string* value = head.find(name);
      if (value != nullptr) order_.metadata.emplace_back(std::string(name), *value);
    }
    if (const std::string* timeout = head.find("grpc-timeout")) {
      order_.timeout = parse_timeout(*timeout);
      malformed_timeout_ = !order_.timeout;
    }
  }

  ~CallExchange() override {
    if (call_ != nullptr) call_->abandon();
  }
  CallExchange(const CallExchange&) = delete;
  CallExchange& operator=(const CallExchange&) = delete;

  bool has_malformed_timeout() const { return malformed_timeout_; }

  void abandon() override {
    if (call_ != nullptr) std::exchange(call_, nullptr)->abandon();
  }
  void on_written() override {}

 protected:
  void call(std::string method, const grpc::ByteBuffer& message, bool last) {
    order_.method = std::move(method);
    call_ = std::make_shared<ForwardedCall>(place_.loop, *this);
    call_->start(order_, place_.stub);
    call_->write(message, last);
  }

  /// Sends the answer of a call as JSON.
  void send_json(const grpc::Status& status, const Trailers& trailers, std::string json) {
    const std::string id = request_id_in(trailers);
    HttpAnswer answer{http_status_of(status.error_code()),
                      "application/json",
                      status.ok() ? std::move(json) : error_json(status, id),
                      {}};
    answer.body += "\n";
    if (!id.empty()) answer.headers.emplace_back("x-request-id", id);
    stream_.send(std::move(answer));
  }

  const HttpPlace& place_;
  AnswerStream& stream_;
  std::shared_ptr<ForwardedCall> call_;

 private:
  CallOrder order_;
  bool malformed_timeout_ = false;
};

class GrpcWebExchange final : public CallExchange {
 public:
  GrpcWebExchange(const HttpPlace& place, const RequestHead& head, AnswerStream& stream)
      : CallExchange(place, head, stream), method_(head.path) {}

  void start(std::string body) override {
    const auto message = message_in(body);
    if (!message.ok()) return on_end(to_grpc(message.status()), {});
    call(method_, buffer_of(*message), true);
  }

  void on_message(grpc::ByteBuffer message) override {
    begin();
    std::vector<grpc::Slice> slices, piece{grpc::Slice(frame_prefix(message.Length()))};
    if (message.Dump(&slices).ok()) {
      piece.insert(piece.end(), slices.begin(), slices.end());
      stream_.send_piece(std::move(piece));
    }
    if (call_ == nullptr) return;  // the connection broke meanwhile
    if (stream_.has_room()) {
      call_->read();
    } else {
      waiting_ = true;
    }
  }

  void on_room() override {
    if (std::exchange(waiting_, false) && call_ != nullptr) call_->read();
  }

  void on_end(const grpc::Status& status, const Trailers& trailers) override {
    call_ = nullptr;
    begin();
    Trailers all = trailers;
    if (status.error_code() != grpc::StatusCode::OK && !has_details(trailers) &&
        !status.error_details().empty()) {
      all.emplace_back("grpc-status-details-bin", status.error_details());
    }
    stream_.send_piece({grpc::Slice(trailers_frame(status, all))});
    stream_.end();
  }

 private:
  static bool has_details(const Trailers& trailers) {
    for (const auto& trailer : trailers) {
      if (trailer.first == "grpc-status-details-bin") return true;
    }
    return false;
  }
  void begin() {
    if (!std::exchange(begun_, true)) stream_.begin(200, kGrpcWebType, {});
  }

  const std::string method_;
  bool begun_ = false, waiting_ = false;
};

class JsonExchange final : public CallExchange {
 public:
  JsonExchange(const HttpPlace& place, const RequestHead& head, AnswerStream& stream)
      : CallExchange(place, head, stream), head_(head) {}

  void start(std::string body) override {
    // Who has no token is refused whatever the message says. To read it takes this thread,
    // which others wait for, long.
    const bool refused = place_.needs_token && head_.find("authorization") == nullptr;
    auto read = read_json_call(head_, refused ? absl::string_view() : body);
    if (auto* refusal = std::get_if<HttpRefusal>(&read)) {
      return stream_.send(refusal_answer(*refusal));
    }
    auto& order = std::get<JsonCall>(read);
    output_ = order.method->output_type();
    call(absl::StrCat("/", order.method->service()->full_name(), "/", order.method->name()),
         buffer_of(order.message), true);
  }

  void on_message(grpc::ByteBuffer message) override {
    message_ = text_of(message);
    call_->read();
  }

  void on_end(const grpc::Status& status, const Trailers& trailers) override {
    call_ = nullptr;
    if (!status.ok()) return send_json(status, trailers, {});
    auto json = to_json(*output_, message_);
    send_json(json.ok() ? grpc::Status::OK : to_grpc(json.status()), trailers,
              json.ok() ? *std::move(json) : std::string());
  }

 private:
  const RequestHead head_;
  const google::protobuf::Descriptor* output_ = nullptr;
  std::string message_;
};

/// Which bytes of which file come.
struct UploadRange {
  std::string digest;
  std::uint64_t first = 0, bytes = 0, total = 0;
};

std::variant<UploadRange, HttpRefusal> read_range(const RequestHead& head) {
  UploadRange range;
  if (!absl::StartsWith(head.path, kUploadPath)) return HttpRefusal{405, "only files are PUT"};
  range.digest = head.path.substr(kUploadPath.size());
  const bool hex = range.digest.size() == 64 &&
                   range.digest.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!hex) return HttpRefusal{400, "PUT /v1/grids/{the SHA-256 of the file, in hexadecimal}"};
  if (!head.content_length) return HttpRefusal{411, "send a Content-Length"};
  range.bytes = range.total = *head.content_length;
  if (range.bytes == 0) return HttpRefusal{400, "a file of 0 bytes is no grid"};
  const std::string* text = head.find("content-range");
  if (text == nullptr) return range;
  const std::vector<absl::string_view> parts = absl::StrSplit(*text, absl::ByAnyChar(" -/"));
  std::uint64_t last = 0;
  if (parts.size() != 4 || parts[0] != "bytes" || !absl::SimpleAtoi(parts[1], &range.first) ||
      !absl::SimpleAtoi(parts[2], &last) || !absl::SimpleAtoi(parts[3], &range.total) ||
      last < range.first || last >= range.total || last - range.first != range.bytes - 1) {
    return HttpRefusal{400,
                       "Content-Range must be `bytes FIRST-LAST/SIZE`, of as many bytes as "
                       "Content-Length says"};
  }
  return range;
}

class UploadExchange final : public CallExchange {
 public:
  UploadExchange(const HttpPlace& place,
                 const RequestHead& head,
                 AnswerStream& stream,
                 UploadRange range)
      : CallExchange(place, head, stream), range_(std::move(range)), offset_(range_.first) {}

  bool takes_pieces() const override { return true; }

  void start(std::string /*body*/) override {
    v1::UploadGridRequest request;
    request.mutable_start()->set_name(absl::StrCat("grids/", range_.digest));
    request.mutable_start()->set_size_bytes(static_cast<std::int64_t>(range_.total));
    call("/tetstream.v1.GridService/UploadGrid", buffer_of(request.SerializeAsString()), false);
  }

  void on_written() override {
    if (!all_) stream_.want_body();
  }

  void on_body(std::string piece, bool last) override {
    if (call_ == nullptr) return;
    all_ = last;
    v1::UploadGridRequest request;
    request.mutable_data()->set_offset(static_cast<std::int64_t>(offset_));
    offset_ += piece.size();
    request.mutable_data()->set_data(std::move(piece));
    call_->write(buffer_of(request.SerializeAsString()), last);
  }

  void on_message(grpc::ByteBuffer message) override {
    message_ = text_of(message);
    call_->read();
  }

  void on_end(const grpc::Status& status, const Trailers& trailers) override {
    call_ = nullptr;
    auto json = to_json(*v1::UploadGridResponse::descriptor(), message_);
    send_json(status, trailers, json.ok() ? *std::move(json) : std::string());
  }

 private:
  const UploadRange range_;
  std::uint64_t offset_;
  bool all_ = false;  ///< the whole body was taken
  std::string message_;
};

class MetricsExchange final : public CallExchange,
                              public std::enable_shared_from_this<MetricsExchange> {
 public:
  MetricsExchange(const HttpPlace& place, const RequestHead& head, AnswerStream& stream)
      : CallExchange(place, head, stream),
        of_last_hour_(head.path != "/metrics"),
        head_alone_(head.method == "HEAD"),
        query_(head.query) {}

  void start(std::string /*body*/) override {
    if (!place_.needs_token) return send_metrics();
    call("/tetstream.v1.MeshService/GetCapabilities", buffer_of(""), true);
  }

  void on_message(grpc::ByteBuffer /*message*/) override { call_->read(); }

  void on_end(const grpc::Status& status, const Trailers& trailers) override {
    call_ = nullptr;
    if (!status.ok()) return send_json(status, trailers, {});
    send_metrics();
  }

  void on_room() override {
    if (std::exchange(waiting_, false)) tell_more();
  }

  void abandon() override {
    telling_.reset();
    CallExchange::abandon();
  }

 private:
  void send_metrics() {
    if (!of_last_hour_) {
      return stream_.send({200, "text/plain; version=0.0.4; charset=utf-8", place_.metrics()});
    }
    const auto query = decode_query(query_);
    absl::string_view names = query ? absl::string_view(*query) : "";
    if (!query || (!names.empty() && !absl::ConsumePrefix(&names, "names="))) {
      return stream_.send(refusal_answer(
          {400, "/metrics/history takes ?names=METRIC,METRIC and nothing else"}));
    }
    if (head_alone_) return stream_.send({200, "application/json", ""});
    stream_.begin(200, "application/json", {});
    telling_ = place_.history(names);
    tell_more();
  }

  /// Between two pieces others have their turns with the loop's thread.
  void tell_more() {
    if (!telling_) return;
    waiting_ = !stream_.has_room();
    if (waiting_) return;
    const std::string piece = telling_->next();
    if (piece.empty()) return stream_.end();
    place_.loop.post([weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->tell_more();
    });
    stream_.send_piece({grpc::Slice(piece)});
  }

  const bool of_last_hour_, head_alone_;
  const std::string query_;
  std::optional<MetricHistory::Telling> telling_;
  bool waiting_ = false;  ///< for room
};

MadeExchange made(std::shared_ptr<CallExchange> exchange) {
  if (exchange->has_malformed_timeout()) {
    return HttpRefusal{400,
                       "grpc-timeout is not up to eight digits and one of H, M, S, m, u, n"};
  }
  return std::static_pointer_cast<Exchange>(std::move(exchange));
}

}  // namespace

MadeExchange grpc_web_exchange(const HttpPlace& place,
                               const RequestHead& head,
                               AnswerStream& stream) {
  return made(std::make_shared<GrpcWebExchange>(place, head, stream));
}

MadeExchange json_exchange(const HttpPlace& place,
                           const RequestHead& head,
                           AnswerStream& stream) {
  return made(std::make_shared<JsonExchange>(place, head, stream));
}

MadeExchange upload_exchange(const HttpPlace& place,
                             const RequestHead& head,
                             AnswerStream& stream) {
  auto range = read_range(head);
  if (auto* refusal = std::get_if<HttpRefusal>(&range)) return std::move(*refusal);
  return made(std::make_shared<UploadExchange>(place, head, stream,
                                               std::get<UploadRange>(std::move(range))));
}

MadeExchange metrics_exchange(const HttpPlace& place,
                              const RequestHead& head,
                              AnswerStream& stream) {
  return made(std::make_shared<MetricsExchange>(place, head, stream));
}

}  // namespace tet
