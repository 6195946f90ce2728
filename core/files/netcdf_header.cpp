#include "core/files/netcdf_header.h"

#include <algorithm>
#include <utility>

#include "core/files/big_endian.h"

namespace tet {
namespace {

template <class Number>
std::string big_endian_text(Number number) {
  const auto bytes = big_endian(number);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Everything begins at a multiple of four.
constexpr std::uint64_t to_four(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

void pad_to_four(std::string& text) { text.resize(to_four(text.size())); }

}  // namespace

NetcdfAttribute text_attribute(std::string name, const std::string& text) {
  return {std::move(name), NetcdfType::kChar, text.size(), text};
}

NetcdfAttribute int_attribute(std::string name, std::int32_t value) {
  return {std::move(name), NetcdfType::kInt, 1, big_endian_text(value)};
}

NetcdfAttribute float_attribute(std::string name, float value) {
  return {std::move(name), NetcdfType::kFloat, 1, big_endian_text(value)};
}

NetcdfHeader::Dimension NetcdfHeader::add_dimension(std::string name, std::uint64_t size) {
  dimensions_.push_back({std::move(name), size});
  return dimensions_.size() - 1;
}

NetcdfHeader::Dimension NetcdfHeader::add_steps(std::string name, std::uint64_t steps) {
  steps_ = steps;
  steps_dimension_ = add_dimension(std::move(name), 0);  // so is it told from the others
  return steps_dimension_;
}

NetcdfHeader::Variable NetcdfHeader::add_variable(std::string name,
                                                  NetcdfType type,
                                                  std::vector<Dimension> dimensions,
                                                  std::vector<NetcdfAttribute> attributes) {
  variables_.push_back({std::move(name), type, std::move(dimensions), std::move(attributes)});
  return variables_.size() - 1;
}

bool NetcdfHeader::has_steps(const Column& column) const {
  return !column.dimensions.empty() && column.dimensions.front() == steps_dimension_;
}

std::uint64_t NetcdfHeader::bytes_of(const Column& column) const {
  std::uint64_t bytes = size_of(column.type);
  for (const Dimension each : column.dimensions) {
    if (each != steps_dimension_) bytes *= dimensions_[each].size;
  }
  return to_four(bytes);
}

void NetcdfHeader::lay_out() {
  for (Column& column : variables_) column.bytes = bytes_of(column);
  wide_ = std::ranges::any_of(
      variables_, [](const Column& column) { return column.bytes >= std::uint64_t{1} << 31; });
  std::uint64_t offset = bytes().size();  // places take the same room whatever they are
  for (const bool steps : {false, true}) {
    for (Column& column : variables_) {
      if (has_steps(column) != steps) continue;
      column.offset = offset;
      offset += steps ? steps_ * column.bytes : column.bytes;
    }
  }
  file_bytes_ = offset;
}

void NetcdfHeader::put_count(std::string& header, std::uint64_t count) const {
  header += wide_ ? big_endian_text(count) : big_endian_text(static_cast<std::uint32_t>(count));
}

void NetcdfHeader::put_name(std::string& header, const std::string& name) const {
  put_count(header, name.size());
  header += name;
  pad_to_four(header);
}

void NetcdfHeader::put_attributes(std::string& header,
                                  const std::vector<NetcdfAttribute>& list) const {
  constexpr std::uint32_t kAttributes = 0x0C;
  header += big_endian_text(list.empty() ? 0U : kAttributes);
  put_count(header, list.size());
  for (const NetcdfAttribute& attribute : list) {
    put_name(header, attribute.name);
    header += big_endian_text(static_cast<std::uint32_t>(attribute.type));
    put_count(header, attribute.count);
    header += attribute.bytes;
    pad_to_four(header);
  }
}

void NetcdfHeader::put_variables(std::string& header) const {
  constexpr std::uint32_t kVariables = 0x0B;
  header += big_endian_text(variables_.empty() ? 0U : kVariables);
  put_count(header, variables_.size());
  for (const Column& column : variables_) {
    put_name(header, column.name);
    put_count(header, column.dimensions.size());
    for (const Dimension each : column.dimensions) put_count(header, each);
    put_attributes(header, column.attributes);
    header += big_endian_text(static_cast<std::uint32_t>(column.type));
    put_count(header, column.bytes);
    header += big_endian_text(column.offset);
  }
}

std::string NetcdfHeader::bytes() const {
  constexpr std::uint32_t kDimensions = 0x0A;
  std::string header = "CDF";
  header += wide_ ? '\5' : '\2';
  put_count(header, steps_);
  header += big_endian_text(dimensions_.empty() ? 0U : kDimensions);
  put_count(header, dimensions_.size());
  for (const NamedSize& each : dimensions_) {
    put_name(header, each.name);
    put_count(header, each.size);
  }
  put_attributes(header, attributes_);
  put_variables(header);
  return header;
}

}  // namespace tet
