// Messages in which one number after the other is extreme, whatever numbers a message has.
#pragma once

#include <functional>
#include <string>

#include <google/protobuf/message.h>

namespace tet::test {

/// Whether a message of this type has any number: of its own, or in a message within it.
bool has_numbers(const google::protobuf::Descriptor& type);

/// A copy of `seed` with one extreme number in it, and what that is: "job.ttl.seconds = -1".
using SeeExtreme =
    std::function<void(const google::protobuf::Message& message, const std::string& what)>;

/// For each number, enumerator, duration and time that the message could have, found by
/// reflection, and each extreme of its type: a copy of `seed` that has it. What lies around a
/// number that the seed does not have is made up so that it is sound where nothing else says
/// what it may be: a scene gets the node that another is made of, regions get a size.
void for_each_extreme(const google::protobuf::Message& seed, const SeeExtreme& see);

}  // namespace tet::test
