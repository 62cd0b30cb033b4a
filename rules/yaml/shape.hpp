#pragma once

/// What a text file of ours may hold, as tables. A reader takes its keys, words and ranges from them, and the JSON
/// Schema for editors is written from them. Where a bound depends on other values, the table has the widest one.

#include <cassert>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

namespace gnomon::yaml {

/// Closed or half-open numbers that a key accepts.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool lowOpen = false; ///< low itself is not allowed.
    bool highOpen = false;
};

struct Key;

/// A kind of value.
struct Shape {
    enum class Kind : uint8_t {
        Text,
        Number,
        Whole, ///< A number without a fraction.
        Flag,  ///< true or false
        Word,  ///< One of `words`.
        List,
        Map,    ///< Of `keys`.
        Named,  ///< A map whose keys are the author's; each value is an `item`.
        Either, ///< One of `choices`.
    };

    Kind kind = Kind::Text;
    Range range{};                             ///< Number, Whole.
    std::span<const std::string_view> words{}; ///< Word.
    const Shape* item = nullptr;               ///< List, Named.
    uint32_t least = 0, most = UINT32_MAX;     ///< List, Named: entries.
    const Key* keys = nullptr;                 ///< Map.
    uint32_t keyCount = 0;
    std::span<const Shape* const> choices{}; ///< Either.
    bool mayBeEmpty = false;                 ///< Nothing may stand in place of a map.
    bool isChange = false;                   ///< It changes another map of this shape: it needs none of the keys.

    std::span<const Key> allKeys() const;
    const Key& at(std::string_view name) const;
};

struct Key {
    std::string_view name;
    const Shape* shape = nullptr;
    std::string_view about{}; ///< For people; the unit where there is one.
    bool isRequired = false;
};

inline std::span<const Key> Shape::allKeys() const
{
    return {keys, keyCount};
}

/// \pre There is such a key: readers ask for what the table has.
inline const Key& Shape::at(std::string_view name) const
{
    uint32_t i = 0;
    while (i < keyCount && keys[i].name != name)
        ++i;
    assert(i < keyCount);
    return keys[i];
}

constexpr Shape number(const Range& range)
{
    return {.kind = Shape::Kind::Number, .range = range};
}
constexpr Shape whole(double low, double high)
{
    return {.kind = Shape::Kind::Whole, .range = {.low = low, .high = high}};
}
constexpr Shape word(std::span<const std::string_view> words)
{
    return {.kind = Shape::Kind::Word, .words = words};
}
constexpr Shape list(const Shape& item, uint32_t least, uint32_t most)
{
    return {.kind = Shape::Kind::List, .item = &item, .least = least, .most = most};
}
constexpr Shape named(const Shape& item, uint32_t most)
{
    return {.kind = Shape::Kind::Named, .item = &item, .most = most};
}
constexpr Shape either(std::span<const Shape* const> choices)
{
    return {.kind = Shape::Kind::Either, .choices = choices};
}
template <std::size_t Count>
constexpr Shape map(const Key (&keys)[Count])
{
    return {.kind = Shape::Kind::Map, .keys = keys, .keyCount = Count};
}
/// The map with other values for some of its keys, where it changes one of the same shape.
constexpr Shape changeOf(Shape map)
{
    map.isChange = true;
    return map;
}

inline constexpr Shape kText{};
inline constexpr Shape kFlag{.kind = Shape::Kind::Flag};

} // namespace gnomon::yaml
