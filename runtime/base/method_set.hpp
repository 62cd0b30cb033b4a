#pragma once
// A set of methods, by index.
#include <algorithm>
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
    /// All below `count`.
    static constexpr MethodSet below(std::uint32_t count)
    {
        MethodSet set;
        for (std::uint32_t first = 0; first < count; first += 64)
            set.words_[first / 64] = ~std::uint64_t{0} >> (64 - std::min(count - first, 64u));
        return set;
    }
    /// Those below `count` that `is` holds for.
    template <typename Is>
    static constexpr MethodSet where(std::uint32_t count, Is&& is)
    {
        MethodSet set;
        for (std::uint32_t first = 0; first < count; first += 64) {
            std::uint64_t word = 0; // not in memory: each bit would wait for the one before
            for (std::uint32_t method = std::min(first + 64, count); method-- > first;)
                word = word << 1 | static_cast<std::uint64_t>(is(method));
            set.words_[first / 64] = word;
        }
        return set;
    }

    constexpr bool has(std::uint32_t method) const { return (words_[method / 64] >> method % 64 & 1) != 0; }
    constexpr void add(std::uint32_t method) { words_[method / 64] |= std::uint64_t{1} << method % 64; }
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
        constexpr explicit Iterator(const Words& words) : words_(words), rest_(words[0]) { skip(); }
        constexpr std::uint32_t operator*() const
        {
            return first_ + static_cast<std::uint32_t>(std::countr_zero(rest_));
        }
        constexpr Iterator& operator++()
        {
            rest_ &= rest_ - 1;
            skip();
            return *this;
        }
        constexpr bool operator==(std::default_sentinel_t) const { return rest_ == 0; }

    private:
        constexpr void skip()
        {
            for (; rest_ == 0 && first_ + 64 < kMaxMethods; rest_ = words_[first_ / 64])
                first_ += 64;
        }

        Words words_;
        std::uint64_t rest_;      ///< Of the word at hand.
        std::uint32_t first_ = 0; ///< Of its methods.
    };
    constexpr Iterator begin() const { return Iterator(words_); }
    constexpr std::default_sentinel_t end() const { return {}; }

private:
    Words words_{};
};

} // namespace gnomon
