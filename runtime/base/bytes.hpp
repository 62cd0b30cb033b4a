#pragma once
// Little-endian bytes, for files.
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace gnomon {

class ByteWriter {
public:
    template <typename Integer>
    void integer(Integer value)
    {
        for (std::size_t i = 0; i < sizeof value; ++i)
            bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
    }
    void real(float value) { integer(std::bit_cast<std::uint32_t>(value)); }
    void real(double value) { integer(std::bit_cast<std::uint64_t>(value)); }
    /// Length in four bytes, then the text.
    void text(std::string_view value)
    {
        integer(static_cast<std::uint32_t>(value.size()));
        bytes += value;
    }
    std::string bytes;
};

/// Reads past the end give zeros and set `failed`, so that a caller checks once per record.
class ByteReader {
public:
    explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
    template <typename Integer>
    Integer integer()
    {
        if (left() < sizeof(Integer)) return fail(), Integer{};
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < sizeof(Integer); ++i)
            value |= std::uint64_t{static_cast<unsigned char>(bytes_[at_++])} << (8 * i);
        return static_cast<Integer>(value);
    }
    float real32() { return std::bit_cast<float>(integer<std::uint32_t>()); }
    double real64() { return std::bit_cast<double>(integer<std::uint64_t>()); }
    std::string_view text(std::size_t most)
    {
        const auto length = integer<std::uint32_t>();
        return length > most ? fail(), std::string_view{} : take(length);
    }
    /// The next bytes as they are.
    std::string_view take(std::size_t length)
    {
        if (left() < length) return fail(), std::string_view{};
        at_ += length;
        return bytes_.substr(at_ - length, length);
    }
    std::size_t left() const { return bytes_.size() - at_; }
    std::size_t at() const { return at_; }
    bool failed = false;

private:
    void fail() { failed = true, at_ = bytes_.size(); }
    std::string_view bytes_;
    std::size_t at_ = 0;
};

} // namespace gnomon
