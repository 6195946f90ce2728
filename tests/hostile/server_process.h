// A tetstreamd to be attacked: started on a free port, watched, and stopped.
#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

#include <absl/status/statusor.h>

namespace tet::test {

/// Killed if it still runs when this goes.
class ServerProcess {
 public:
  /// Its store, port file and log are in `folder`; `settings` are further arguments.
  /// Errors: kUnavailable (it did not serve within ten seconds).
  static absl::StatusOr<ServerProcess> start(const std::string& program,
                                             const std::string& folder,
                                             const std::vector<std::string>& settings);
  ~ServerProcess();
  ServerProcess(ServerProcess&& from) noexcept;
  ServerProcess& operator=(ServerProcess&&) = delete;

  const std::string& address() const { return address_; }
  bool alive();
  /// The processor time that it has used, and its decoders have, seconds.
  double processor_seconds() const;
  /// The most memory it ever had at once, bytes.
  std::uint64_t peak_resident_bytes() const;
  /// Asks it to stop. True when it did, as it should.
  bool stop();

 private:
  explicit ServerProcess(pid_t pid) : pid_(pid) {}

  pid_t pid_;
  std::string address_;
};

}  // namespace tet::test
