#pragma once
// A set of methods, by index.
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <iterator>

namespace gnomon {

/// A log of decisions names a method by a byte, and 255 is none.
inline constexpr std::uint32_t kMaxMethods = 255;

class MethodSet {
    static constexpr std::uint32_t kWords = (kMaxMethods + 63) / 64;
    using Words = std::array<std::uint64_t, kWords>;

public:
    constexpr MethodSet() = default;
    constexpr MethodSet(std::initializer_list<std::uint32_t> methods)
    {
        for (const std::uint32_t method : methods)
            add(method);
    }

    constexpr bool has(std::uint32_t method) const { return (words_[method / 64] >> method % 64 & 1) != 0; }
    constexpr void add(std::uint32_t method) { words_[method / 64] |= std::uint64_t{1} << method % 64; }
    /// Adds what `is`.
    constexpr void addIf(std::uint32_t method, bool is) { words_[method / 64] |= std::uint64_t{is} << method % 64; }
    constexpr void remove(std::uint32_t method) { words_[method / 64] &= ~(std::uint64_t{1} << method % 64); }
    constexpr std::uint32_t count() const
    {
        std::uint32_t sum = 0;
        for (const std::uint64_t word : words_)
            sum += static_cast<std::uint32_t>(std::popcount(word));
        return sum;
    }
    constexpr bool empty() const { return *this == MethodSet{}; }
    constexpr bool meets(const MethodSet& other) const { return !(*this & other).empty(); }

    constexpr MethodSet& operator|=(const MethodSet& other)
    {
        for (std::uint32_t i = 0; i < kWords; ++i)
            words_[i] |= other.words_[i];
        return *this;
    }
    constexpr MethodSet& operator&=(const MethodSet& other)
    {
        for (std::uint32_t i = 0; i < kWords; ++i)
            words_[i] &= other.words_[i];
        return *this;
    }
    constexpr MethodSet& operator-=(const MethodSet& other)
    {
        for (std::uint32_t i = 0; i < kWords; ++i)
            words_[i] &= ~other.words_[i];
        return *this;
    }
    friend constexpr MethodSet operator|(MethodSet a, const MethodSet& b) { return a |= b; }
    friend constexpr MethodSet operator&(MethodSet a, const MethodSet& b) { return a &= b; }
    friend constexpr MethodSet operator-(MethodSet a, const MethodSet& b) { return a -= b; }
    friend constexpr bool operator==(const MethodSet&, const MethodSet&) = default;

    /// In ascending order; of the set as it was at begin().
    class Iterator {
    public:
        constexpr explicit Iterator(const Words& words) : rest_(words) { skip(); }
        constexpr std::uint32_t operator*() const
        {
            return word_ * 64 + static_cast<std::uint32_t>(std::countr_zero(rest_[word_]));
        }
        constexpr Iterator& operator++()
        {
            rest_[word_] &= rest_[word_] - 1;
            skip();
            return *this;
        }
        constexpr bool operator==(std::default_sentinel_t) const { return word_ == kWords; }

    private:
        constexpr void skip()
        {
            while (word_ < kWords && rest_[word_] == 0)
                ++word_;
        }

        Words rest_;
        std::uint32_t word_ = 0;
    };
    constexpr Iterator begin() const { return Iterator(words_); }
    constexpr std::default_sentinel_t end() const { return {}; }

private:
    Words words_{};
};

} // namespace gnomon
