// What a client is told of an error, as text that can be compared.
#pragma once

#include <algorithm>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include <absl/strings/str_cat.h>
#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/wire/sha256.h"

namespace tet::test {

/// What the details of a status say, a line for each fact.
inline std::string text_of(const google::rpc::ErrorInfo& info) {
  std::string text = absl::StrCat("  ErrorInfo ", info.domain(), " ", info.reason(), "\n");
  std::vector<std::string> facts;
  for (const auto& [key, value] : info.metadata())
    facts.push_back(absl::StrCat(key, "=", value));
  std::sort(facts.begin(), facts.end());
  for (const std::string& fact : facts) absl::StrAppend(&text, "    ", fact, "\n");
  return text;
}

inline std::string text_of(const google::protobuf::Any& detail) {
  google::rpc::ErrorInfo info;
  google::rpc::RetryInfo retry;
  google::rpc::BadRequest bad;
  if (detail.UnpackTo(&info)) return text_of(info);
  if (detail.UnpackTo(&retry)) {
    return absl::StrCat("  RetryInfo ", retry.retry_delay().seconds(), " s\n");
  }
  if (detail.UnpackTo(&bad)) {
    return absl::StrCat("  BadRequest ", bad.field_violations(0).field(), "\n");
  }
  return absl::StrCat("  ", detail.type_url(), "\n");
}

inline google::rpc::Status details_of(const grpc::Status& status) {
  google::rpc::Status rpc;
  EXPECT_TRUE(rpc.ParseFromString(status.error_details())) << status.error_message();
  return rpc;
}

inline std::string reason_in(const grpc::Status& status) {
  google::rpc::ErrorInfo info;
  const google::rpc::Status rpc = details_of(status);
  if (rpc.details_size() == 0 || !rpc.details(0).UnpackTo(&info)) return "";
  return info.reason();
}

/// With `{sha256}` in place of each digest.
inline std::string without_digests(std::string text) {
  constexpr std::size_t kDigits = 64;
  for (std::size_t at = 0; at + kDigits <= text.size(); ++at) {
    if (is_sha256_hex(std::string_view(text).substr(at, kDigits))) {
      text.replace(at, kDigits, "{sha256}");
    }
  }
  return text;
}

/// With `{n}` in place of how many seconds something took, or was waited for.
inline std::string without_seconds(const std::string& text) {
  return std::regex_replace(text, std::regex("for [0-9]+ s\\b"), "for {n} s");
}

}  // namespace tet::test
