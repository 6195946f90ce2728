#include "proto/convert/request_rules.h"

#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "tests/support/feature_requests.h"

namespace tet {
namespace {

using test::FeatureRequest;

/// Calls `use` with each pair of features that one request can have.
template <class Use>
void for_each_pair(const Use& use) {
  const auto all = all_features();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (can_be_asked_together(all[i], all[j])) use(all[i], all[j]);
    }
  }
}

std::string pair_text(Feature a, Feature b) {
  const FeatureNames names = field_names();
  return names.of(a) + " beside " + names.of(b);
}

bool is_another_call(Feature feature) {
  return feature == Feature::kSession || feature == Feature::kJob ||
         feature == Feature::kPoints;
}

TEST(RequestRules, NameEachPairOnceAndOnlyPairsThatCanBeAskedFor) {
  std::set<std::pair<Feature, Feature>> seen;
  for (const RequestRule& rule : request_rules()) {
    const auto pair = std::minmax(rule.feature, rule.beside);
    EXPECT_TRUE(seen.insert(pair).second) << pair_text(rule.feature, rule.beside);
    EXPECT_TRUE(can_be_asked_together(rule.feature, rule.beside))
        << pair_text(rule.feature, rule.beside);
    EXPECT_EQ(find_rule(rule.beside, rule.feature), &rule);
    EXPECT_EQ(rule.refusal.empty(), rule.outcome != Outcome::kRefused);
    EXPECT_EQ(rule.instead.empty(), rule.outcome != Outcome::kRefused);
    EXPECT_FALSE(rule.why.empty());
  }
}

TEST(RequestRules, BeginARefusalWithItsField) {
  for (const RequestRule& rule : request_rules()) {
    if (rule.outcome != Outcome::kRefused) continue;
    const std::string field = field_names().of(rule.feature);
    const std::string message = message_of(rule, field_names());
    EXPECT_THAT(message, testing::StartsWith(field)) << message;
    EXPECT_THAT(message, testing::Not(testing::HasSubstr("$"))) << message;
  }
}

TEST(RequestRules, HoldForEveryPairThatAMessageCanHave) {
  const FeatureRequest requests(name_of_grid(std::string(64, 'a')));
  for_each_pair([&](Feature a, Feature b) {
    SCOPED_TRACE(pair_text(a, b));
    const v1::StreamMeshRequest request = requests.with(a, b);
    const RequestRule* const rule = find_rule(a, b);
    const bool is_refused = rule != nullptr && rule->outcome == Outcome::kRefused;
    Features other_call;
    for (const Feature feature : {a, b}) other_call.add(feature, is_another_call(feature));
    const absl::Status status = other_call == Features()
                                    ? parse_stream_request(request).status()
                                    : check_rules(request.mesh(), other_call);
    if (!is_refused) {
      EXPECT_TRUE(status.ok()) << status;
      return;
    }
    EXPECT_EQ(status.message(), message_of(*rule, names_in(request.mesh())));
    EXPECT_EQ(reason_of(status), "INVALID_FIELD");
  });
}

TEST(RequestRules, AreTheSameForTheMesherAndForAMessage) {
  const FeatureRequest requests(name_of_grid(std::string(64, 'a')));
  for_each_pair([&](Feature a, Feature b) {
    const auto order = parse_mesh_request(requests.with(a, b).mesh());
    if (!order.ok()) return;
    const Features of_core = features_of(order->request);
    const Features of_message = features_of(requests.with(a, b).mesh());
    for (Feature feature = Feature::kIso; feature <= Feature::kSkipStatistics;
         feature = static_cast<Feature>(static_cast<int>(feature) + 1)) {
      EXPECT_EQ(of_core.has(feature), of_message.has(feature))
          << pair_text(a, b) << ": " << field_names().of(feature);
    }
  });
}

TEST(RequestRules, KeepNoEarlierMeshThatIsSentWhole) {
  const FeatureRequest requests(name_of_grid(std::string(64, 'a')));
  for (const Feature feature : all_features()) {
    const auto order = parse_stream_request(requests.with(Feature::kEarlierMesh, feature));
    if (!order.ok()) continue;
    const RequestRule* const rule = find_rule(Feature::kEarlierMesh, feature);
    EXPECT_EQ(order->base_digest.empty(), rule != nullptr) << field_names().of(feature);
  }
}

std::string outcome_text(const RequestRule& rule) {
  switch (rule.outcome) {
    case Outcome::kRefused:
      return absl::StrFormat("refused: \"%s\"", message_of(rule, field_names()));
    case Outcome::kSentWhole:
      return "sent whole";
    case Outcome::kIgnored:
      return "statistics are there all the same";
  }
  return "";
}

/// As docs/requests.md has it.
std::string table_text() {
  std::string table =
      "| asked for | beside | what becomes of it | why |\n| --- | --- | --- | --- |\n";
  const FeatureNames names = field_names();
  for (const RequestRule& rule : request_rules()) {
    absl::StrAppendFormat(&table, "| `%s` | `%s` | %s | %s |\n", names.of(rule.feature),
                          names.of(rule.beside), outcome_text(rule), rule.why);
  }
  return table;
}

TEST(RequestRules, AreThoseThatTheDocumentHas) {
  std::ifstream file(REQUESTS_DOCUMENT);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(table_text()), std::string::npos)
      << "put this into docs/requests.md:\n"
      << table_text();
}

}  // namespace
}  // namespace tet
