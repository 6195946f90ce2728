#include "tests/server/extreme_numbers.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <sstream>
#include <vector>

#include "tetstream/v1/meshes.pb.h"

namespace tet::test {
namespace {

namespace v1 = ::tetstream::v1;

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using Path = std::vector<const FieldDescriptor*>;

constexpr std::size_t kDeepest = 12;

bool is_number(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
    case FieldDescriptor::CPPTYPE_STRING:
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return false;
    default:
      return true;
  }
}

void find_numbers(const Descriptor& type, Path& path, std::vector<Path>& found) {
  if (path.size() > kDeepest) return;
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    path.push_back(&field);
    if (is_number(field)) found.push_back(path);
    if (field.message_type() != nullptr) find_numbers(*field.message_type(), path, found);
    path.pop_back();
  }
}

std::vector<Path> numbers_of(const Descriptor& type) {
  Path path;
  std::vector<Path> found;
  find_numbers(type, path, found);
  return found;
}

// What is around a number.

/// A node that others are made of; or a sizing at the surface, which most of its numbers need.
void make_up(Message& message) {
  if (auto* const scene = dynamic_cast<v1::Scene*>(&message)) {
    scene->add_nodes()->set_name("a");
    scene->mutable_nodes(0)->mutable_sphere()->set_radius(1);
    scene->add_nodes();
  } else if (auto* const sizing = dynamic_cast<v1::Sizing*>(&message)) {
    sizing->set_grade_surface(true);
    sizing->set_coarsest(1);
  }
}

/// Ones where a number must be set, and the node above where another one is named.
void fill_in(const FieldDescriptor& field, Message& message) {
  constexpr int kAxes = 3;
  const Reflection& reflection = *message.GetReflection();
  const bool is_double = field.cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE;
  if (field.name() == "of") {
    field.is_repeated() ? reflection.AddString(&message, &field, "a")
                        : reflection.SetString(&message, &field, "a");
  } else if (is_double && !field.is_repeated() && !field.has_presence()) {
    reflection.SetDouble(&message, &field, 1);
  } else if (is_double && field.is_repeated()) {
    const double one = field.name() == "min" ? -1 : 1;
    for (int i = 0; i < kAxes; ++i) reflection.AddDouble(&message, &field, one);
  }
}

void fill_in(Message& message) {
  const Descriptor& type = *message.GetDescriptor();
  for (int i = 0; i < type.field_count(); ++i) fill_in(*type.field(i), message);
  make_up(message);
}

/// The last one of a list, so that it is the node that a scene is; all others have one.
Message& within(Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  if (field.is_repeated()) {
    const int size = reflection.FieldSize(message, &field);
    if (size > 0) return *reflection.MutableRepeatedMessage(&message, &field, size - 1);
    Message& added = *reflection.AddMessage(&message, &field);
    fill_in(added);
    return added;
  }
  const bool is_new = !reflection.HasField(message, &field);
  Message& inner = *reflection.MutableMessage(&message, &field);
  if (is_new) fill_in(inner);
  return inner;
}

/// A scene takes the grid's place, and has no node that nobody needs.
void settle(Message& message) {
  if (auto* const request = dynamic_cast<v1::MeshRequest*>(&message)) {
    if (request->has_scene()) request->clear_name();
  }
  if (auto* const scene = dynamic_cast<v1::Scene*>(&message)) {
    if (scene->nodes_size() == 2 &&
        scene->nodes(1).DebugString().find("of: \"a\"") == std::string::npos) {
      scene->mutable_nodes()->SwapElements(0, 1);
      scene->mutable_nodes()->RemoveLast();
    }
  }
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->message_type() == nullptr || field->is_map()) continue;
    const Reflection& reflection = *message.GetReflection();
    if (!field->is_repeated()) {
      settle(*reflection.MutableMessage(&message, field));
      continue;
    }
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      settle(*reflection.MutableRepeatedMessage(&message, field, i));
    }
  }
}

// The numbers.

template <class Number>
std::vector<Number> integers() {
  using Limits = std::numeric_limits<Number>;
  // 315576000001 s is more than protobuf's longest duration, 253402300800 s beyond the year
  // 9999.
  std::vector<Number> all{Limits::min(), 0, 1, Limits::max() - 1, Limits::max()};
  if constexpr (Limits::is_signed) all.push_back(-1);
  if constexpr (sizeof(Number) == 8) {
    all.insert(all.end(), {315'576'000'000, 315'576'000'001, 253'402'300'799, 253'402'300'800});
  } else {
    all.insert(all.end(), {999'999'999, 1'000'000'000});
  }
  return all;
}

template <class Number>
std::vector<Number> floats() {
  using Limits = std::numeric_limits<Number>;
  return {Limits::quiet_NaN(),
          Limits::infinity(),
          -Limits::infinity(),
          Limits::max(),
          Limits::lowest(),
          Limits::denorm_min(),
          Limits::min(),
          static_cast<Number>(1e-30),
          static_cast<Number>(1e30),
          0,
          static_cast<Number>(-0.0),
          -1};
}

/// Sets a number: the last of a list.
template <class Number, class Set, class Add, class Replace>
void put(Message& message,
         const FieldDescriptor& field,
         Number number,
         const Set& set,
         const Add& add,
         const Replace& replace) {
  const Reflection& reflection = *message.GetReflection();
  if (!field.is_repeated()) return (reflection.*set)(&message, &field, number);
  const int size = reflection.FieldSize(message, &field);
  if (size == 0) return (reflection.*add)(&message, &field, number);
  (reflection.*replace)(&message, &field, size - 1, number);
}

class Extremes {
 public:
  Extremes(const Message& seed, const SeeExtreme& see) : seed_(seed), see_(see) {}

  void see(const Path& path) {
    switch (path.back()->cpp_type()) {
      case FieldDescriptor::CPPTYPE_INT32:
        return each(path, integers<std::int32_t>(), &Reflection::SetInt32,
                    &Reflection::AddInt32, &Reflection::SetRepeatedInt32);
      case FieldDescriptor::CPPTYPE_INT64:
        return each(path, integers<std::int64_t>(), &Reflection::SetInt64,
                    &Reflection::AddInt64, &Reflection::SetRepeatedInt64);
      case FieldDescriptor::CPPTYPE_UINT32:
        return each(path, integers<std::uint32_t>(), &Reflection::SetUInt32,
                    &Reflection::AddUInt32, &Reflection::SetRepeatedUInt32);
      case FieldDescriptor::CPPTYPE_UINT64:
        return each(path, integers<std::uint64_t>(), &Reflection::SetUInt64,
                    &Reflection::AddUInt64, &Reflection::SetRepeatedUInt64);
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return each(path, floats<double>(), &Reflection::SetDouble, &Reflection::AddDouble,
                    &Reflection::SetRepeatedDouble);
      case FieldDescriptor::CPPTYPE_FLOAT:
        return each(path, floats<float>(), &Reflection::SetFloat, &Reflection::AddFloat,
                    &Reflection::SetRepeatedFloat);
      case FieldDescriptor::CPPTYPE_ENUM:
        return each(path, integers<std::int32_t>(), &Reflection::SetEnumValue,
                    &Reflection::AddEnumValue, &Reflection::SetRepeatedEnumValue);
      default:
        return;
    }
  }

 private:
  template <class Number, class Set, class Add, class Replace>
  void each(const Path& path,
            const std::vector<Number>& numbers,
            const Set& set,
            const Add& add,
            const Replace& replace) {
    for (const Number number : numbers) {
      const std::unique_ptr<Message> message(seed_.New());
      message->CopyFrom(seed_);
      std::ostringstream what;
      Message* at = message.get();
      for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        at = &within(*at, *path[i]);
        what << path[i]->name() << ".";
      }
      put(*at, *path.back(), number, set, add, replace);
      settle(*message);
      what << path.back()->name() << " = " << number;
      see_(*message, what.str());
    }
  }

  const Message& seed_;
  const SeeExtreme& see_;
};

}  // namespace

bool has_numbers(const Descriptor& type) { return !numbers_of(type).empty(); }

void for_each_extreme(const Message& seed, const SeeExtreme& see) {
  Extremes extremes(seed, see);
  for (const Path& path : numbers_of(*seed.GetDescriptor())) extremes.see(path);
}

}  // namespace tet::test
