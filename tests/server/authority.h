// Certificates of a test's own, made by Debian's openssl while the test runs.
#pragma once

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "tests/server/test_folder.h"

namespace tet::test {

struct CertifiedKey {
  std::string cert, key;  ///< paths
};

/// Signs certificates for 127.0.0.1 and localhost.
class Authority {
 public:
  Authority(const TestFolder& folder, const std::string& name) : folder_(folder), name_(name) {
    run("req -x509 " + new_key(name) + " -addext basicConstraints=critical,CA:TRUE -out " +
        cert());
  }

  std::string cert() const { return folder_.file(name_ + ".pem"); }

  /// Its subject is CN=`name`. With 0 days it has expired when it is made.
  CertifiedKey sign(const std::string& name, int days = 1) const {
    const CertifiedKey made{folder_.file(name + ".pem"), folder_.file(name + ".key")};
    const std::string request = folder_.file(name + ".csr");
    run("req " + new_key(name) + " -addext subjectAltName=IP:127.0.0.1,DNS:localhost -out " +
        request);
    run("x509 -req -in " + request + " -copy_extensions copy -days " + std::to_string(days) +
        " -CA " + cert() + " -CAkey " + folder_.file(name_ + ".key") + " -out " + made.cert);
    return made;
  }

 private:
  std::string new_key(const std::string& name) const {
    return "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=" + name +
           " -keyout " + folder_.file(name + ".key");
  }

  static void run(const std::string& arguments) {
    const std::string command = "openssl " + arguments + " 2>/dev/null";
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
  }

  const TestFolder& folder_;
  const std::string name_;
};

}  // namespace tet::test
