// Writing a stream of messages to a client, one after the other, until the call ends.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/support/server_callback.h>

#include "server/rpc/calls.h"
#include "server/rpc/stall_watch.h"

namespace tet {

/// A call that sends messages. It never waits: each event (something is ready to be sent, a
/// message was written, the client is gone) moves it one step, on whichever thread the event
/// came. One message is on its way at a time, and a client that takes none for too long loses
/// its call.
///
/// Lives until gRPC is done with it and the last task that refers to it has run.
class StreamWriter : public Stallable, public std::enable_shared_from_this<StreamWriter> {
 public:
  // Events of gRPC's.
  void written(bool ok);
  void cancelled();

  std::optional<Stallable::Clock::time_point> waiting_since() override;
  void give_up(std::chrono::seconds waited) override;

 protected:
  StreamWriter(CallRegistry& calls, grpc::CallbackServerContext& context, std::string method);

  // What a kind of stream adds; with the lock.
  /// Makes the message that is to be written now, if there is one. May end the call.
  virtual bool prepare() = 0;
  /// A message was written; true after the last there is.
  virtual bool after_write() { return false; }
  /// The call ends now.
  virtual void note_end() {}
  /// The last moment to note anything for the log.
  virtual void note_finish() {}

  // And without it.
  /// Hands what was prepared to gRPC.
  virtual void write() = 0;
  /// Ends gRPC's call.
  virtual void finish(const grpc::Status& status) = 0;
  /// Everything was written.
  virtual void sent_all() {}
  /// What is made for this call is no longer needed.
  virtual void abandon() {}
  /// Whoever sees the call's end may begin the next at once: what it held is given back.
  virtual void before_finish() {}

  /// Takes one step if there is one to take.
  void advance();
  /// The call ends with `status` as soon as nothing is being written; the first status counts.
  void close(const absl::Status& status);
  /// Does so, and abandons what is being made for it.
  void break_off(const absl::Status& status);
  /// Ends the call with the lock held, and takes no step.
  void end(const absl::Status& status);
  /// Whether it ends; with the lock.
  bool ended() const { return ended_; }
  /// Whether that is as it should; with the lock.
  bool ended_well() const { return ended_ && status_.ok(); }
  /// Adds a field to the call's log line from a task; without the lock. Where the call ends,
  /// that line may be written on another thread at this moment, so nothing is added.
  void note_from_task(const std::string& key, const std::string& value);
  /// Takes a step of this call's, on any thread; what that throws ends the call.
  void guard(const std::function<void()>& step);
  /// Calls `start`, which begins an operation of gRPC's, unless the call ends.
  void start_operation(const std::function<void()>& start);
  /// From now on the server's end ends the call, too.
  void end_with_server();

  grpc::CallbackServerContext& context_;  ///< there until gRPC is done
  Call call_;
  std::mutex mutex_;  ///< guards what kinds of stream keep, and all below

 private:
  enum class Step { kWait, kWrite, kFinish };

  Step next_step();
  absl::Status gone() const;
  void hold_while(const std::function<void()>& action);

  bool writing_ = false;
  int held_ = 0;  ///< by as many the call may not finish now
  bool ended_ = false, finished_ = false;
  Stallable::Clock::time_point write_start_{};
  absl::Status status_;  ///< how the call ends
};

}  // namespace tet
