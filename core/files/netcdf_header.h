// The header of a classic netCDF file, which is small and says where everything else lies: what
// follows it are plain columns. No library is needed to write them, nor can one fail on a full
// disk.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tet {

enum class NetcdfType : std::uint32_t { kChar = 2, kInt = 4, kFloat = 5, kDouble = 6 };

constexpr std::uint64_t size_of(NetcdfType type) {
  return type == NetcdfType::kChar ? 1 : type == NetcdfType::kDouble ? 8 : 4;
}

/// A name and a value as the file has it.
struct NetcdfAttribute {
  std::string name;
  NetcdfType type = NetcdfType::kChar;
  std::uint64_t count = 0;
  std::string bytes;  ///< big-endian
};
NetcdfAttribute text_attribute(std::string name, const std::string& text);
NetcdfAttribute int_attribute(std::string name, std::int32_t value);
NetcdfAttribute float_attribute(std::string name, float value);

/// Dimensions, attributes and variables of a file with at most one record. The variant of the
/// format is the oldest that has room for its variables: offsets of 64 bits (CDF-2), and where
/// one takes 2 GiB or more sizes of 64 bits, too (CDF-5).
class NetcdfHeader {
 public:
  using Dimension = std::size_t;
  using Variable = std::size_t;

  Dimension add_dimension(std::string name, std::uint64_t size);
  /// The one along which there is a record for each step; `steps` is 0 or 1. Its variables come
  /// after all others.
  Dimension add_steps(std::string name, std::uint64_t steps);
  void add_attribute(NetcdfAttribute attribute) { attributes_.push_back(std::move(attribute)); }
  Variable add_variable(std::string name,
                        NetcdfType type,
                        std::vector<Dimension> dimensions,
                        std::vector<NetcdfAttribute> attributes = {});

  /// Gives every variable its place. Nothing is added afterwards.
  void lay_out();
  std::uint64_t offset_of(Variable variable) const { return variables_[variable].offset; }
  std::uint64_t file_bytes() const noexcept { return file_bytes_; }
  std::string bytes() const;

 private:
  struct NamedSize {
    std::string name;
    std::uint64_t size = 0;
  };
  struct Column {
    std::string name;
    NetcdfType type;
    std::vector<Dimension> dimensions;
    std::vector<NetcdfAttribute> attributes;
    std::uint64_t bytes = 0, offset = 0;
  };

  bool has_steps(const Column& column) const;
  std::uint64_t bytes_of(const Column& column) const;

  // Each adds to a header.
  void put_count(std::string& header, std::uint64_t count) const;
  void put_name(std::string& header, const std::string& name) const;
  void put_attributes(std::string& header, const std::vector<NetcdfAttribute>& list) const;
  void put_variables(std::string& header) const;

  std::vector<NamedSize> dimensions_;
  std::vector<NetcdfAttribute> attributes_;
  std::vector<Column> variables_;
  Dimension steps_dimension_ = SIZE_MAX;
  std::uint64_t steps_ = 0, file_bytes_ = 0;
  bool wide_ = false;  ///< CDF-5
};

}  // namespace tet
